#include "worker/textures/pyramid.h"

#include <half.h>

#include <algorithm>
#include <cmath>

#include "proto/status.h"
#include "worker/textures/downsample.h"

namespace penumbra {
namespace {

/// x modulo n in [0, n).
int wrapped(int x, int n) {
  const int r = x % n;
  return r < 0 ? r + n : r;
}

}  // namespace

template <class T>
Pyramid<T>::Pyramid(Texels texels) : channels_(texels.channels) {
  PENUMBRA_CHECK(texels.width > 0 && texels.height > 0 && (channels_ == 1 || channels_ == 3));
  for (;;) {
    levels_.push_back(
        {texels.width, texels.height, std::vector<T>(texels.values.begin(), texels.values.end())});
    if (texels.width == 1 && texels.height == 1) return;
    texels = halved(texels);
  }
}

template <class T>
size_t Pyramid<T>::bytes() const {
  size_t sum = 0;
  for (const Level& level : levels_) sum += level.values.size() * sizeof(T);
  return sum;
}

template <class T>
Rgb Pyramid<T>::texel(const Level& level, int x, int y, Wrap wrap) const {
  switch (wrap) {
    case Wrap::kRepeat:
      x = wrapped(x, level.width);
      y = wrapped(y, level.height);
      break;
    case Wrap::kClamp:
      x = std::clamp(x, 0, level.width - 1);
      y = std::clamp(y, 0, level.height - 1);
      break;
    case Wrap::kBlack:
      if (x < 0 || y < 0 || x >= level.width || y >= level.height) return Rgb(0);
      break;
  }
  const T* at = &level.values[(static_cast<size_t>(y) * level.width + x) * channels_];
  return channels_ == 1 ? Rgb(at[0]) : Rgb(at[0], at[1], at[2]);
}

template <class T>
Rgb Pyramid<T>::bilinear(const Level& level, const Vec2f& st, Wrap wrap) const {
  const float s = st.x * level.width - 0.5f, t = st.y * level.height - 0.5f;
  const int x = static_cast<int>(std::floor(s)), y = static_cast<int>(std::floor(t));
  const float a = s - x, b = t - y;
  return (texel(level, x, y, wrap) * (1 - a) + texel(level, x + 1, y, wrap) * a) * (1 - b) +
         (texel(level, x, y + 1, wrap) * (1 - a) + texel(level, x + 1, y + 1, wrap) * a) * b;
}

/// Level (fractional, may be negative) on which `width`, in texture coordinates, is one texel.
template <class T>
float Pyramid<T>::level_of(float width) const {
  return std::log2(width * std::max(levels_[0].width, levels_[0].height));
}

template <class T>
Rgb Pyramid<T>::trilinear(float width, const Vec2f& st, Wrap wrap) const {
  const float level = level_of(width);
  const int last = static_cast<int>(levels_.size()) - 1;
  if (!(level > 0)) return bilinear(levels_[0], st, wrap);
  if (level >= last) return texel(levels_[last], 0, 0, wrap);
  const int i = static_cast<int>(level);
  const float t = level - i;
  return bilinear(levels_[i], st, wrap) * (1 - t) + bilinear(levels_[i + 1], st, wrap) * t;
}

// Elliptically weighted average, Heckbert 1989. The level is the one on which the shorter axis is a texel;
// an ellipse longer than max_anisotropy times that is widened, which blurs but bounds the work.
template <class T>
Rgb Pyramid<T>::ewa(const Vec2f& st, Vec2f major, Vec2f minor, const ImageSampling& sampling) const {
  if (major.length2() < minor.length2()) std::swap(major, minor);
  const float longer = major.length();
  if (!std::isfinite(longer)) return texel(levels_.back(), 0, 0, sampling.wrap);
  float shorter = minor.length();
  if (shorter == 0) return bilinear(levels_[0], st, sampling.wrap);
  if (shorter * sampling.max_anisotropy < longer) {
    minor *= longer / (shorter * sampling.max_anisotropy);
    shorter = longer / sampling.max_anisotropy;
  }
  const float level = std::max(0.0f, level_of(shorter));
  const int last = static_cast<int>(levels_.size()) - 1;
  if (!(level < last)) return texel(levels_[last], 0, 0, sampling.wrap);
  const int i = static_cast<int>(level);
  const float t = level - i;
  const Rgb fine = ellipse(levels_[i], st, major, minor, sampling.wrap);
  if (t == 0) return fine;
  return fine * (1 - t) + ellipse(levels_[i + 1], st, major, minor, sampling.wrap) * t;
}

template <class T>
Rgb Pyramid<T>::ellipse(const Level& level, const Vec2f& st, const Vec2f& axis0, const Vec2f& axis1,
                        Wrap wrap) const {
  const float w = static_cast<float>(level.width), h = static_cast<float>(level.height);
  const float s = st.x * w - 0.5f, t = st.y * h - 0.5f;
  const Vec2f d0(axis0.x * w, axis0.y * h), d1(axis1.x * w, axis1.y * h);
  // A x² + B x y + C y² < F; one texel² added to each axis, so that the ellipse never falls between texels.
  const float a = d0.y * d0.y + d1.y * d1.y + 1;
  const float b = -2 * (d0.x * d0.y + d1.x * d1.y);
  const float c = d0.x * d0.x + d1.x * d1.x + 1;
  const float f = a * c - b * b / 4;
  const float half_x = std::sqrt(c),
              half_y = std::sqrt(a);  // of the bounds: √(C F / (AC - B²/4)), F = AC - B²/4
  const int x0 = static_cast<int>(std::ceil(s - half_x)), x1 = static_cast<int>(std::floor(s + half_x));
  const int y0 = static_cast<int>(std::ceil(t - half_y)), y1 = static_cast<int>(std::floor(t + half_y));
  Rgb sum(0);
  float weights = 0;
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const float dx = x - s, dy = y - t;
      const float r2 = (a * dx * dx + b * dx * dy + c * dy * dy) / f;
      if (r2 >= 1) continue;
      const float weight = std::exp(-2 * r2) - std::exp(-2.0f);  // falls to 0 at the ellipse's border
      sum += texel(level, x, y, wrap) * weight;
      weights += weight;
    }
  }
  return weights > 0 ? sum / weights : bilinear(level, st, wrap);
}

template <class T>
Rgb Pyramid<T>::lookup(const Vec2f& st, const Vec2f& dx, const Vec2f& dy,
                       const ImageSampling& sampling) const {
  switch (sampling.filter) {
    case Filter::kPoint:
      return texel(levels_[0], static_cast<int>(std::floor(st.x * levels_[0].width)),
                   static_cast<int>(std::floor(st.y * levels_[0].height)), sampling.wrap);
    case Filter::kBilinear:
      return bilinear(levels_[0], st, sampling.wrap);
    case Filter::kTrilinear: {
      // Twice the footprint's longest component, as pbrt: a texel is a sample, not an area.
      const float width = 2 * std::max({std::abs(dx.x), std::abs(dx.y), std::abs(dy.x), std::abs(dy.y)});
      return trilinear(width, st, sampling.wrap);
    }
    case Filter::kEwa:
      return ewa(st, dx, dy, sampling);
  }
  PENUMBRA_CHECK(!"unknown filter");
  return Rgb(0);
}

template class Pyramid<Imath::half>;
template class Pyramid<float>;

}  // namespace penumbra

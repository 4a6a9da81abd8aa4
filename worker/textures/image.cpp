#include "worker/textures/image.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

/// A coordinate brought near [0,1], so that its texel index fits an int whatever the scene's numbers are.
/// What lies beyond the border by more than a texel is all alike for clamp and black.
float tame(float s, Wrap wrap) {
  if (wrap == Wrap::kRepeat) s -= std::floor(s);
  return s >= -2 ? std::min(s, 3.0f) : -2.0f;  // also for what is not a number
}

std::variant<Pyramid<Imath::half>, Pyramid<float>> make_pyramid(Texels texels) {
  const auto fits = [](float v) { return std::abs(v) <= HALF_MAX; };
  if (std::all_of(texels.values.begin(), texels.values.end(), fits))
    return Pyramid<Imath::half>(std::move(texels));
  return Pyramid<float>(std::move(texels));
}

}  // namespace

Image::Image(Texels texels) : pyramid_(make_pyramid(std::move(texels))) {}

Rgb Image::lookup(const Vec2f& st, const Vec2f& dst_dx, const Vec2f& dst_dy,
                  const ImageSampling& sampling) const {
  // pbrt's t runs upwards, rows run downwards.
  const Vec2f at(tame(st.x, sampling.wrap), tame(1 - st.y, sampling.wrap));
  const Vec2f dx(dst_dx.x, -dst_dx.y), dy(dst_dy.x, -dst_dy.y);
  return std::visit([&](const auto& p) { return p.lookup(at, dx, dy, sampling); }, pyramid_);
}

int Image::width() const {
  return std::visit([](const auto& p) { return p.width(); }, pyramid_);
}

int Image::height() const {
  return std::visit([](const auto& p) { return p.height(); }, pyramid_);
}

int Image::levels() const {
  return std::visit([](const auto& p) { return p.levels(); }, pyramid_);
}

size_t Image::bytes() const {
  return std::visit([](const auto& p) { return p.bytes(); }, pyramid_);
}

}  // namespace penumbra

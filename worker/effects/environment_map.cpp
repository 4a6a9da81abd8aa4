#include "worker/effects/environment_map.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/status.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

/// Direction <-> unit square. Equirectangular: u = φ/2π, v = θ/π, z up (pbrt-v3 §12.6). Equal-area:
/// Clarberg 2008, the octahedron whose texels all have the same solid angle (pbrt-v4 §3.8.3).
Vec2d equirectangular(const Vec3d& w) {
  double phi = std::atan2(w.y, w.x);
  if (phi < 0) phi += 2 * kPi;
  const double theta = std::atan2(std::hypot(w.x, w.y), w.z);
  return {phi / (2 * kPi), theta / kPi};
}

Vec2d equal_area_place(const Vec3d& w) {
  const double x = std::abs(w.x), y = std::abs(w.y), z = std::abs(w.z);
  const double r = std::sqrt(std::max(0.0, 1 - z));
  const double phi = x == 0 && y == 0 ? 0 : std::atan2(std::min(x, y), std::max(x, y)) * 2 / kPi;
  const double share = x < y ? 1 - phi : phi;
  double v = share * r, u = r - v;
  if (w.z < 0) {
    std::swap(u, v);
    u = 1 - u;
    v = 1 - v;
  }
  return {(std::copysign(u, w.x) + 1) / 2, (std::copysign(v, w.y) + 1) / 2};
}
Vec3d equal_area_direction(const Vec2d& st) {
  const double u = 2 * st.x - 1, v = 2 * st.y - 1, up = std::abs(u), vp = std::abs(v);
  const double signed_distance = 1 - (up + vp), d = std::abs(signed_distance), r = 1 - d;
  const double phi = (r == 0 ? 1 : (vp - up) / r + 1) * kPi / 4;
  const double z = std::copysign(1 - r * r, signed_distance);
  const double scale = r * std::sqrt(std::max(0.0, 2 - r * r));
  return {std::copysign(std::cos(phi), u) * scale, std::copysign(std::sin(phi), v) * scale, z};
}

/// The interval of a running sum that u falls into, and where within it.
size_t pick(const double* sums, size_t n, double u, double& rest) {
  const double target = u * sums[n];
  size_t i = size_t(std::upper_bound(sums, sums + n + 1, target) - sums);
  i = std::min(i == 0 ? 0 : i - 1, n - 1);
  while (i > 0 && sums[i + 1] == sums[i]) --i;
  const double width = sums[i + 1] - sums[i];
  rest = width > 0 ? std::min((target - sums[i]) / width, 1 - 0x1p-53) : 0;
  return i;
}

}  // namespace

double luminance_of(const Rgb& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

absl::Status EnvironmentMap::read(const std::string& path, bool square_is_equal_area) {
  OIIO::ImageBuf image(path);
  if (!image.read(0, 0, true, OIIO::TypeDesc::FLOAT)) return absl::InvalidArgumentError(image.geterror());
  const OIIO::ImageSpec& spec = image.spec();
  width_ = spec.width;
  height_ = spec.height;
  const bool grey = spec.nchannels < 3;
  std::vector<float> values(size_t(width_) * size_t(height_) * size_t(spec.nchannels));
  image.get_pixels(OIIO::ROI::All(), OIIO::TypeDesc::FLOAT, values.data());
  const bool srgb = image.nativespec().format.basetype == OIIO::TypeDesc::UINT8;
  texels_.resize(size_t(width_) * size_t(height_));
  for (size_t i = 0; i < texels_.size(); ++i) {
    const float* v = values.data() + i * size_t(spec.nchannels);
    texels_[i] = grey ? Rgb(v[0]) : Rgb(v[0], v[1], v[2]);
    if (srgb)
      for (int c = 0; c < 3; ++c)
        texels_[i][c] = texels_[i][c] <= 0.04045f ? texels_[i][c] / 12.92f
                                                  : std::pow((texels_[i][c] + 0.055f) / 1.055f, 2.4f);
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(texels_[i][c]) || texels_[i][c] < 0)
        return invalid_input("texel {} of {} is negative or not finite", i, path);
  }
  equal_area_ = square_is_equal_area && width_ == height_;
  tabulate();
  return absl::OkStatus();
}

double EnvironmentMap::texel_solid_angle(int y) const {
  if (equal_area_) return 4 * kPi / (double(width_) * height_);
  const double top = std::cos(kPi * y / height_), bottom = std::cos(kPi * (y + 1) / height_);
  return (top - bottom) * 2 * kPi / width_;
}

void EnvironmentMap::tabulate() {
  columns_.assign((size_t(width_) + 1) * size_t(height_), 0);
  rows_.assign(size_t(height_) + 1, 0);
  for (int y = 0; y < height_; ++y) {
    double* sums = columns_.data() + size_t(y) * (size_t(width_) + 1);
    for (int x = 0; x < width_; ++x)
      sums[x + 1] = sums[x] + std::max(0.0, luminance_of(texel(x, y))) * texel_solid_angle(y);
    rows_[size_t(y) + 1] = rows_[size_t(y)] + sums[width_];
  }
}

void EnvironmentMap::texel_of(const Vec3d& w, int& x, int& y) const {
  const Vec2d st = equal_area_ ? equal_area_place(w) : equirectangular(w);
  x = std::clamp(int(st.x * width_), 0, width_ - 1);
  y = std::clamp(int(st.y * height_), 0, height_ - 1);
}

Vec3d EnvironmentMap::direction_at(double x, double y) const {
  if (equal_area_) return equal_area_direction({x / width_, y / height_});
  const double phi = 2 * kPi * x / width_, theta = kPi * y / height_;
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

Vec3d EnvironmentMap::sample(const Vec2d& u, int& x, int& y) const {
  double rest_x = 0, rest_y = 0;
  y = int(pick(rows_.data(), size_t(height_), u.y, rest_y));
  x = int(pick(row(y), size_t(width_), u.x, rest_x));
  if (equal_area_) return direction_at(x + rest_x, y + rest_y);
  // Uniform in cosθ within the row, so that the density is constant over the texel's solid angle.
  const double top = std::cos(kPi * y / height_), bottom = std::cos(kPi * (y + 1) / height_);
  const double z = top + rest_y * (bottom - top), phi = 2 * kPi * (x + rest_x) / width_;
  const double r = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
  return {r * std::cos(phi), r * std::sin(phi), z};
}

double EnvironmentMap::luminance_at(const Vec3d& w) const {
  int x = 0, y = 0;
  texel_of(w, x, y);
  return std::max(0.0, luminance_of(texel(x, y)));
}

namespace {

/// Most rows of a likeness.
constexpr int kMostRows = 512;
constexpr double kLeastOfMean = 1e-3;
constexpr int kSubsamples = 4;

/// Of each cell of a likeness the larger of two means: over points of the cell, and over points of the map's
/// texels that fall into it. The first serves where cells are smaller than texels, the second where they are
/// larger.
class Likeness {
 public:
  Likeness(int width, int height)
      : width_(width), height_(height), of_cells_(cells(), 0), of_texels_(cells(), 0), hits_(cells(), 0) {}
  /// `luminance(x, y)`: at a place of the grid, in cells from its corner.
  template <class Luminance>
  void look_at_cells(const Luminance& luminance) {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x)
        for (int i = 0; i < kSubsamples * kSubsamples; ++i)
          of_cells_[cell(x, y)] += luminance(x + (i % kSubsamples + 0.5) / kSubsamples,
                                             y + (i / kSubsamples + 0.5) / kSubsamples) /
                                   (kSubsamples * kSubsamples);
  }
  /// A point of a texel; `st`: its place in the unit square of the grid.
  void add(const Vec2d& st, double luminance) {
    const size_t c =
        cell(std::clamp(int(st.x * width_), 0, width_ - 1), std::clamp(int(st.y * height_), 0, height_ - 1));
    of_texels_[c] += luminance;
    ++hits_[c];
  }
  std::vector<double> finish(double least) {
    for (size_t c = 0; c < cells(); ++c)
      of_cells_[c] = std::max({of_cells_[c], hits_[c] > 0 ? of_texels_[c] / hits_[c] : 0, least});
    return std::move(of_cells_);
  }

 private:
  size_t cells() const { return size_t(width_) * size_t(height_); }
  size_t cell(int x, int y) const { return size_t(y) * size_t(width_) + size_t(x); }
  int width_, height_;
  std::vector<double> of_cells_, of_texels_, hits_;
};

}  // namespace

double EnvironmentMap::least() const {
  return kLeastOfMean * total() / (4 * kPi);
}

ArcTable EnvironmentMap::meridians() const {
  if (!equal_area_) {
    std::vector<double> values;
    values.reserve(texels_.size());
    for (const Rgb& t : texels_) values.push_back(std::max(0.0, luminance_of(t)));
    return ArcTable(width_, height_, values);
  }
  const int rows_of = std::min(height_, kMostRows), columns_of = 2 * rows_of;
  Likeness likeness(columns_of, rows_of);
  likeness.look_at_cells([&](double x, double y) {
    const double phi = 2 * kPi * x / columns_of, theta = kPi * y / rows_of;
    return luminance_at({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
  });
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      for (int i = 0; i < kSubsamples * kSubsamples; ++i)
        likeness.add(equirectangular(direction_at(x + (i % kSubsamples + 0.5) / kSubsamples,
                                                  y + (i / kSubsamples + 0.5) / kSubsamples)),
                     std::max(0.0, luminance_of(texel(x, y))));
  return ArcTable(columns_of, rows_of, likeness.finish(least()));
}

WindowTable EnvironmentMap::seen_through(const Imath::M33d& to_local) const {
  const int n = std::min(height_, kMostRows);
  Likeness likeness(n, n);
  likeness.look_at_cells([&](double x, double y) {
    return luminance_at((window_direction({x / n, y / n}) * to_local).normalized());
  });
  // A texel is no larger than a cell, or the cells have seen it: its centre will do.
  const Imath::M33d to_window = to_local.inverse();
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const Vec3d w = direction_at(x + 0.5, y + 0.5) * to_window;
      if (w.z > 0) likeness.add(window_place(w), std::max(0.0, luminance_of(texel(x, y))));
    }
  std::vector<double> values = likeness.finish(least());
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      values[size_t(y) * size_t(n) + size_t(x)] *=
          window_solid_angle(window_direction({(x + 0.5) / n, (y + 0.5) / n}));
  return WindowTable(n, n, values);
}

}  // namespace penumbra

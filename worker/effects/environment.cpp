#include "worker/effects/environment.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>

#include "proto/status.h"
#include "worker/sampling/warp.h"
#include "worker/textures/textures.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

double luminance(const Rgb& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

/// Direction <-> unit square. Equirectangular: u = φ/2π, v = θ/π, z up (pbrt-v3 §12.6). Equal-area:
/// Clarberg 2008, the octahedron whose texels all have the same solid angle (pbrt-v4 §3.8.3).
Vec2d equirectangular(const Vec3d& w) {
  double phi = std::atan2(w.y, w.x);
  if (phi < 0) phi += 2 * kPi;
  const double theta = std::atan2(std::hypot(w.x, w.y), w.z);
  return {phi / (2 * kPi), theta / kPi};
}

Vec2d equal_area(const Vec3d& w) {
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

struct Environment::Map {
  int width = 0, height = 0;
  bool equal_area = false;
  std::vector<Rgb> texels;
  /// Running sums of luminance × texel solid angle: per row over its columns, and over the rows.
  std::vector<double> columns, rows;
  mutable std::once_flag arcs_made;
  mutable std::optional<ArcTable> arcs;

  const Rgb& texel(int x, int y) const { return texels[size_t(y) * size_t(width) + size_t(x)]; }
  const double* row(int y) const { return columns.data() + size_t(y) * (size_t(width) + 1); }

  /// Solid angle of any texel of row y.
  double texel_solid_angle(int y) const {
    if (equal_area) return 4 * kPi / (double(width) * height);
    const double top = std::cos(kPi * y / height), bottom = std::cos(kPi * (y + 1) / height);
    return (top - bottom) * 2 * kPi / width;
  }

  void tabulate() {
    columns.assign((size_t(width) + 1) * size_t(height), 0);
    rows.assign(size_t(height) + 1, 0);
    for (int y = 0; y < height; ++y) {
      double* sums = columns.data() + size_t(y) * (size_t(width) + 1);
      for (int x = 0; x < width; ++x)
        sums[x + 1] = sums[x] + std::max(0.0, luminance(texel(x, y))) * texel_solid_angle(y);
      rows[size_t(y) + 1] = rows[size_t(y)] + sums[width];
    }
  }

  void texel_of(const Vec3d& w, int& x, int& y) const {
    const Vec2d st = equal_area ? penumbra::equal_area(w) : equirectangular(w);
    x = std::clamp(int(st.x * width), 0, width - 1);
    y = std::clamp(int(st.y * height), 0, height - 1);
  }
};

namespace {

/// Reads a map as linear RGB; grey maps are spread over the channels.
absl::Status read_map(const std::string& path, int& width, int& height, std::vector<Rgb>& texels) {
  OIIO::ImageBuf image(path);
  if (!image.read(0, 0, true, OIIO::TypeDesc::FLOAT)) return absl::InvalidArgumentError(image.geterror());
  const OIIO::ImageSpec& spec = image.spec();
  width = spec.width;
  height = spec.height;
  const bool grey = spec.nchannels < 3;
  std::vector<float> values(size_t(width) * size_t(height) * size_t(spec.nchannels));
  image.get_pixels(OIIO::ROI::All(), OIIO::TypeDesc::FLOAT, values.data());
  const bool srgb = image.nativespec().format.basetype == OIIO::TypeDesc::UINT8;
  texels.resize(size_t(width) * size_t(height));
  for (size_t i = 0; i < texels.size(); ++i) {
    const float* v = values.data() + i * size_t(spec.nchannels);
    texels[i] = grey ? Rgb(v[0]) : Rgb(v[0], v[1], v[2]);
    if (srgb)
      for (int c = 0; c < 3; ++c)
        texels[i][c] = texels[i][c] <= 0.04045f ? texels[i][c] / 12.92f
                                                : std::pow((texels[i][c] + 0.055f) / 1.055f, 2.4f);
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(texels[i][c]) || texels[i][c] < 0)
        return invalid_input("texel {} of {} is negative or not finite", i, path);
  }
  return absl::OkStatus();
}

Imath::M33f linear_part(const Matrix& m) {
  Imath::M33f r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r[i][j] = float(m[i][j]);
  return r;
}

}  // namespace

absl::StatusOr<Environment> Environment::build(const LightEntity& light, const SceneDescription& description,
                                               const SceneFiles& files, bool strict,
                                               std::vector<std::string>& warnings) {
  Environment e;
  const std::string at = description.place(light.loc);
  e.to_world_ = linear_part(light.placement.start);
  e.to_light_ = linear_part(light.placement.start.inverse());
  if (const Param* radiance = light.params.find("L")) {
    ASSIGN_OR_RETURN(e.scale_, to_rgb(*radiance, description, files));
  }
  if (const Param* scale = light.params.find("scale")) {
    if (scale->numbers.size() >= 3)
      e.scale_ *= Rgb(float(scale->numbers[0]), float(scale->numbers[1]), float(scale->numbers[2]));
    else
      e.scale_ *= float(light.params.number("scale", 1));
  }
  // A portal changes no picture, only how soon it converges: pbrt looks through it alone.
  if (const Param* portal = light.params.find("portal"))
    warnings.push_back(fmt::format("{}: the portal is not used: light from all of the sky is sampled",
                                   description.place(portal->loc)));
  const bool v4 = light.params.find("filename") != nullptr;
  const std::string name = light.params.string(v4 ? "filename" : "mapname", "");
  if (name.empty()) return e;
  auto path = files.path_of(name);
  if (!path.ok()) {
    const std::string what = fmt::format("{}: environment map '{}' is missing; constant 1 instead", at, name);
    if (strict) return absl::InvalidArgumentError(what);
    warnings.push_back(what);
    return e;
  }
  auto map = std::make_shared<Map>();
  if (absl::Status s = read_map(*path, map->width, map->height, map->texels); !s.ok())
    return invalid_input("{}: environment map '{}': {}", at, name, message_of(s));
  map->equal_area = v4 && map->width == map->height;
  map->tabulate();
  if (map->rows.back() > 0)
    e.map_ = std::move(map);
  else
    e.scale_ = Rgb(0);
  return e;
}

Rgb Environment::radiance(const Vec3f& direction) const {
  if (!map_) return scale_;
  int x = 0, y = 0;
  const Vec3f local = direction * to_light_;
  map_->texel_of(Vec3d(local).normalized(), x, y);
  return map_->texel(x, y) * scale_;
}

EnvironmentSample Environment::sample(const Vec2d& u) const {
  EnvironmentSample s;
  if (!map_) {
    s.wi = Vec3f(square_to_sphere(u));
    s.radiance = scale_;
    s.pdf = 1 / (4 * kPi);
    return s;
  }
  double rest_x = 0, rest_y = 0;
  const int y = int(pick(map_->rows.data(), size_t(map_->height), u.y, rest_y));
  const int x = int(pick(map_->row(y), size_t(map_->width), u.x, rest_x));
  Vec3d local;
  if (map_->equal_area) {
    local = equal_area_direction({(x + rest_x) / map_->width, (y + rest_y) / map_->height});
  } else {
    // Uniform in cosθ within the row, so that the density is constant over the texel's solid angle.
    const double top = std::cos(kPi * y / map_->height), bottom = std::cos(kPi * (y + 1) / map_->height);
    const double z = top + rest_y * (bottom - top), phi = 2 * kPi * (x + rest_x) / map_->width;
    const double r = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
    local = {r * std::cos(phi), r * std::sin(phi), z};
  }
  s.wi = (Vec3f(local) * to_world_).normalized();
  s.radiance = map_->texel(x, y) * scale_;
  s.pdf = luminance(map_->texel(x, y)) / map_->rows.back();
  return s;
}

double Environment::pdf(const Vec3f& direction) const {
  if (!map_) return 1 / (4 * kPi);
  int x = 0, y = 0;
  const Vec3f local = direction * to_light_;
  map_->texel_of(Vec3d(local).normalized(), x, y);
  return luminance(map_->texel(x, y)) / map_->rows.back();
}

namespace {

/// Most rows of a likeness of an equal-area map.
constexpr int kMostArcRows = 512;
/// What a cell has at least, of the mean: where no subsample fell light may still be.
constexpr double kLeastOfMean = 1e-3;
constexpr int kSubsamples = 4;

}  // namespace

/// Of each cell the larger of two means: over points of the cell, and over points of the map's texels that
/// fall into it. The first serves where cells are smaller than texels, the second where they are larger.
ArcTable Environment::likeness(const Map& map) {
  const int height = std::min(map.height, kMostArcRows), width = 2 * height;
  const auto cells = size_t(width) * size_t(height);
  std::vector<double> of_cells(cells, 0), of_texels(cells, 0), hits(cells, 0);
  const auto lit = [&map](const Vec3d& w) {
    int x = 0, y = 0;
    map.texel_of(w, x, y);
    return luminance(map.texel(x, y));
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int i = 0; i < kSubsamples * kSubsamples; ++i) {
        const double phi = 2 * kPi * (x + (i % kSubsamples + 0.5) / kSubsamples) / width;
        const double theta = kPi * (y + (i / kSubsamples + 0.5) / kSubsamples) / height;
        const Vec3d w(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
        of_cells[size_t(y) * size_t(width) + size_t(x)] += lit(w) / (kSubsamples * kSubsamples);
      }
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      for (int i = 0; i < kSubsamples * kSubsamples; ++i) {
        const Vec3d w = equal_area_direction({(x + (i % kSubsamples + 0.5) / kSubsamples) / map.width,
                                              (y + (i / kSubsamples + 0.5) / kSubsamples) / map.height});
        const Vec2d st = equirectangular(w);
        const auto cell = size_t(std::clamp(int(st.y * height), 0, height - 1)) * size_t(width) +
                          size_t(std::clamp(int(st.x * width), 0, width - 1));
        of_texels[cell] += luminance(map.texel(x, y));
        ++hits[cell];
      }
  const double least = kLeastOfMean * map.rows.back() / (4 * kPi);
  for (size_t c = 0; c < cells; ++c)
    of_cells[c] = std::max({of_cells[c], hits[c] > 0 ? of_texels[c] / hits[c] : 0, least});
  return ArcTable(width, height, of_cells);
}

const ArcTable& Environment::arcs() const {
  static const ArcTable constant(1, 1, {1.0});
  if (!map_) return constant;
  std::call_once(map_->arcs_made, [this] {
    if (map_->equal_area) {
      map_->arcs.emplace(likeness(*map_));
      return;
    }
    std::vector<double> values;
    values.reserve(map_->texels.size());
    for (const Rgb& texel : map_->texels) values.push_back(std::max(0.0, luminance(texel)));
    map_->arcs.emplace(map_->width, map_->height, values);
  });
  return *map_->arcs;
}

Rgb Environment::radiance(int column, int row, const Vec3f& direction) const {
  return map_ && !map_->equal_area ? map_->texel(column, row) * scale_ : radiance(direction);
}

double Environment::mean_luminance() const {
  return luminance(scale_) * (map_ ? map_->rows.back() / (4 * kPi) : 1);
}

}  // namespace penumbra

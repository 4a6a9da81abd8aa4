#include "worker/textures/mapping.h"

#include <cmath>
#include <numbers>

#include "proto/status.h"

namespace penumbra {
namespace {

Vec2f spherical(const Vec3f& p) {
  // atan2 keeps its digits at the poles, where acos(z/r) does not; the origin itself maps to (0,0).
  const float theta = std::atan2(std::hypot(p.x, p.y), p.z);
  float phi = std::atan2(p.y, p.x);
  if (phi < 0) phi += 2 * std::numbers::pi_v<float>;
  return {theta * std::numbers::inv_pi_v<float>, phi * (std::numbers::inv_pi_v<float> / 2)};
}

Vec2f cylindrical(const Vec3f& p) {
  const float azimuth =
      (std::numbers::pi_v<float> + std::atan2(p.y, p.x)) * (std::numbers::inv_pi_v<float> / 2);
  return {azimuth, p.normalized().z};
}

/// A curved mapping's footprint by differences over a tenth of a pixel, as pbrt takes them: short enough for
/// the curvature, long enough for single precision. `periodic`: the coordinate whose jump by 1 is no change.
template <class Map>
TextureCoordinates by_differences(const Map& map_point, const TexturePoint& point, int periodic) {
  constexpr float kStep = 0.1f;
  TextureCoordinates c;
  c.st = map_point(point.p);
  const auto difference = [&](const Vec3f& dp) {
    Vec2f d = map_point(point.p + dp * kStep) - c.st;
    d[periodic] -= std::round(d[periodic]);
    return d / kStep;
  };
  c.dx = difference(point.dpdx);
  c.dy = difference(point.dpdy);
  return c;
}

TextureCoordinates map_with(const UvMapping& m, const TexturePoint& point) {
  return {point.uv * m.scale + m.delta, point.duvdx * m.scale, point.duvdy * m.scale};
}

TextureCoordinates map_with(const SphericalMapping& m, const TexturePoint& point) {
  return by_differences([&](const Vec3f& p) { return spherical(p * m.texture_from_world); }, point, 1);
}

TextureCoordinates map_with(const CylindricalMapping& m, const TexturePoint& point) {
  return by_differences([&](const Vec3f& p) { return cylindrical(p * m.texture_from_world); }, point, 0);
}

TextureCoordinates map_with(const PlanarMapping& m, const TexturePoint& point) {
  const auto project = [&](const Vec3f& v) { return Vec2f(v ^ m.s_axis, v ^ m.t_axis); };
  return {project(point.p) + m.delta, project(point.dpdx), project(point.dpdy)};
}

Vec3f vector_param(const Params& params, std::string_view name, const Vec3f& fallback) {
  const Param* param = params.find(name);
  if (param == nullptr || param->numbers.size() != 3) return fallback;
  return Vec3f(Vec3d(param->numbers[0], param->numbers[1], param->numbers[2]));
}

}  // namespace

absl::StatusOr<Mapping2D> make_mapping(const TextureEntity& entity, const SceneDescription& description) {
  const Params& params = entity.params;
  const auto number = [&](const char* name, double fallback) {
    return static_cast<float>(params.number(name, fallback));
  };
  const Vec2f delta(number("udelta", 0), number("vdelta", 0));
  const std::string kind = params.string("mapping", "uv");
  if (kind == "uv") return UvMapping{{number("uscale", 1), number("vscale", 1)}, delta};
  if (kind == "planar") {
    return PlanarMapping{vector_param(params, "v1", {1, 0, 0}), vector_param(params, "v2", {0, 1, 0}), delta};
  }
  const Imath::M44f inverse(entity.placement.start.inverse());
  if (kind == "spherical") return SphericalMapping{inverse};
  if (kind == "cylindrical") return CylindricalMapping{inverse};
  return invalid_input("{}: unknown texture mapping '{}'", description.place(params.find("mapping")->loc),
                       kind);
}

TextureCoordinates map(const Mapping2D& mapping, const TexturePoint& point) {
  return std::visit([&](const auto& m) { return map_with(m, point); }, mapping);
}

}  // namespace penumbra

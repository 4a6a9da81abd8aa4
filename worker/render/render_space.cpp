#include "worker/render/render_space.h"

#include <cmath>

#include "proto/status.h"
#include "scenes/curve.h"
#include "scenes/mesh.h"
#include "scenes/transforms.h"
#include "worker/render/light_params.h"

namespace penumbra {
namespace {

/// A scene is far away if its extent is less than this share of its distance: ten of single precision's 24
/// digits would be zeros in every difference.
constexpr double kFar = 0x1p-10;
/// The new origin is a multiple of this share of the distance (as a power of two), so that coordinates that
/// single precision could tell apart there stay exact when they are moved.
constexpr int kGridBits = 20;

std::optional<Vec3d> first_vertex(const Params& params) {
  const Param* p = params.find("P");
  if (p == nullptr || p->numbers.size() < 3) return std::nullopt;
  return Vec3d(p->numbers[0], p->numbers[1], p->numbers[2]);
}

/// Some point of a shape, in its object space.
absl::StatusOr<Vec3d> point_of(const ShapeEntity& shape, const SceneDescription& description,
                               const SceneFiles& files) {
  if (const auto vertex = first_vertex(shape.params)) return *vertex;
  if (shape.type == "quad") return vector_param(shape.params, "o");
  if (shape.type != "plymesh") return Vec3d(0);  // quadrics: about their object's origin
  std::vector<std::string> told_later;
  ASSIGN_OR_RETURN(const TriangleMesh mesh, make_mesh(shape, description, files, told_later));
  return mesh.positions.empty() ? Vec3d(0) : Vec3d(mesh.positions[0]);
}

void move(Placement& placement, const Matrix& to_render) {
  placement.start *= to_render;
  placement.end *= to_render;
}

/// A portal's corners are in world space, whatever the light's placement.
void move_portal(Params& params, const Vec3d& origin) {
  for (Param& p : params.all)
    if (p.name == "portal")
      for (size_t i = 0; i < p.numbers.size(); ++i) p.numbers[i] -= origin[int(i % 3)];
}

/// Solid textures map world points by their placement, spherical and cylindrical mappings by its inverse, the
/// planar one knows no placement.
void move(TextureEntity& texture, const Vec3d& origin) {
  const std::string mapping = texture.params.string("mapping", "uv");
  if (mapping == "spherical" || mapping == "cylindrical") {
    move(texture.placement, translation(-origin));
    return;
  }
  if (mapping == "planar") {
    const auto shifted = [&](const char* delta, const char* axis, const Vec3d& otherwise) {
      Param p;
      p.type = "float";
      p.name = delta;
      p.loc = texture.loc;
      p.numbers = {texture.params.number(delta, 0) +
                   vector_param(texture.params, axis, otherwise).dot(origin)};
      texture.params.all.push_back(p);
    };
    shifted("udelta", "v1", {1, 0, 0});
    shifted("vdelta", "v2", {0, 1, 0});
    return;
  }
  texture.placement.start = translation(origin) * texture.placement.start;
  texture.placement.end = translation(origin) * texture.placement.end;
}

}  // namespace

absl::StatusOr<std::optional<Vec3d>> distant_origin(const SceneDescription& description,
                                                    const SceneFiles& files) {
  const Matrix& world_to_camera = description.camera_placement.start;
  if (world_to_camera.determinant() == 0) return std::optional<Vec3d>();  // the camera's own check says so
  const Vec3d camera = transform_point(world_to_camera.gjInverse(), Vec3d(0));
  const double distance = camera.length();
  if (!(distance > 0) || !std::isfinite(distance)) return std::optional<Vec3d>();
  const auto is_near_camera = [&](const Vec3d& p) { return (p - camera).length() < kFar * distance; };
  for (const InstanceEntity& instance : description.instances)
    if (!is_near_camera(transform_point(instance.placement.start, Vec3d(0)))) return std::optional<Vec3d>();
  for (const ShapeEntity& shape : description.shapes) {
    if (!has_mesh(shape) && !has_tubes(shape)) continue;
    // Whatever can be told without reading a file is told first: most scenes end here.
    if (shape.type != "plymesh" || first_vertex(shape.params)) {
      ASSIGN_OR_RETURN(const Vec3d p, point_of(shape, description, files));
      if (!is_near_camera(transform_point(shape.placement.start, p))) return std::optional<Vec3d>();
    }
  }
  for (const ShapeEntity& shape : description.shapes) {
    if (shape.type != "plymesh") continue;
    ASSIGN_OR_RETURN(const Vec3d p, point_of(shape, description, files));
    if (!is_near_camera(transform_point(shape.placement.start, p))) return std::optional<Vec3d>();
  }
  const double grid = std::ldexp(1, std::ilogb(distance) - kGridBits);
  return std::optional<Vec3d>(Vec3d(std::round(camera.x / grid) * grid, std::round(camera.y / grid) * grid,
                                    std::round(camera.z / grid) * grid));
}

SceneDescription moved_to(const Vec3d& origin, const SceneDescription& description) {
  SceneDescription moved = description;
  const Matrix to_render = translation(-origin);
  moved.camera_placement.start = translation(origin) * moved.camera_placement.start;
  moved.camera_placement.end = translation(origin) * moved.camera_placement.end;
  // Shapes of objects are placed by their instances.
  for (ShapeEntity& shape : moved.shapes) move(shape.placement, to_render);
  for (InstanceEntity& instance : moved.instances) move(instance.placement, to_render);
  for (LightEntity& light : moved.lights) {
    move(light.placement, to_render);
    move_portal(light.params, origin);
  }
  for (MediumEntity& medium : moved.media) move(medium.placement, to_render);
  for (TextureEntity& texture : moved.textures) move(texture, origin);
  return moved;
}

}  // namespace penumbra

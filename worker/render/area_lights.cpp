// Area lights: from a shape of the description to emitters whose surface is the placed mesh.
#include <cmath>
#include <limits>
#include <numbers>

#include "proto/status.h"
#include "scenes/similarity.h"
#include "worker/lights/moving_light.h"
#include "worker/render/light_params.h"
#include "worker/render/scene_builder.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3f point(const Matrix& m, const Vec3d& p) { return Vec3f(transform_point(m, p)); }
Vec3f direction(const Matrix& m, const Vec3d& d) { return Vec3f(transform_direction(m, d)); }

/// A shape's own space and the light's: the world, or the space of the object of one that moves.
struct LightSpace {
  Matrix to_light;
  bool flip = false;      ///< as SceneMesh::flip, in the world
  bool mirrors = false;   ///< the way from the mesh's space to the world does
  bool similar = false;   ///< the shape's placement is a similarity, at all times
  double scale = 1;       ///< of to_light, if it is one

  LightSpace(const ShapeEntity& shape, const SceneMesh& placed, bool moves)
      : to_light(moves ? Matrix() : shape.placement.start), flip(placed.flip) {
    double at_end = 1;
    similar = is_similarity(shape.placement.start, scale) && is_similarity(shape.placement.end, at_end);
    if (!moves) return;
    mirrors = swaps_handedness(shape.placement.start);
    flip = placed.flip != mirrors;
    scale = 1;
  }
};

bool full_sweep(const Params& params) { return params.number("phimax", 360) >= 360; }

/// The exact shape behind a mesh, where there is one; otherwise each triangle is a light.
/// `turned`: emission is against the shape's own orientation.
std::optional<LightShape> exact_shape(const ShapeEntity& shape, const LightSpace& space) {
  const Matrix& m = space.to_light;
  const Params& params = shape.params;
  const double scale = space.scale;
  if (shape.type == "quad") {
    QuadShape quad{point(m, vector_param(params, "o")), direction(m, vector_param(params, "u")),
                   direction(m, vector_param(params, "v"))};
    // Turned by running v backwards from the other edge: u and v keep their directions for the mixes.
    if (space.flip) {
      quad.o += quad.v;
      quad.v = -quad.v;
    }
    return quad;
  }
  if (shape.type == "sphere" && space.similar && full_sweep(params)) {
    const double radius = params.number("radius", 1);
    if (params.number("zmin", -radius) > -radius || params.number("zmax", radius) < radius) return std::nullopt;
    return SphereShape{point(m, Vec3d(0)), float(radius * scale), shape.reverse_orientation};
  }
  if (shape.type == "disk" && space.similar && full_sweep(params)) {
    const double radius = params.number("radius", 1), height = params.number("height", 0);
    Vec3d n = Vec3d(direction(m, {0, 0, 1})).normalized();
    if (shape.reverse_orientation) n = -n;
    return DiskShape{point(m, {0, 0, height}), Vec3f(n), float(radius * scale),
                     float(params.number("innerradius", 0) * scale)};
  }
  if (shape.type == "cylinder" && space.similar && full_sweep(params)) {
    const double radius = params.number("radius", 1), z0 = params.number("zmin", -1), z1 = params.number("zmax", 1);
    return CylinderShape{point(m, {0, 0, z0}), direction(m, {0, 0, z1 - z0}), float(radius * scale),
                         shape.reverse_orientation};
  }
  return std::nullopt;
}

/// A bilinear patch or a pair of triangles that is a parallelogram to the last bit is a quad light.
std::optional<QuadShape> as_parallelogram(const ShapeEntity& shape, const SceneMesh& placed,
                                          const LightSpace& space) {
  const TriangleMesh& mesh = placed.mesh;
  if (shape.type != "bilinearmesh" || mesh.triangles() != 2 || mesh.positions.size() != 4) return std::nullopt;
  // The corner that both triangles have and whose two neighbours do not share another edge with it.
  const Vec3f &p00 = mesh.positions[0], &p10 = mesh.positions[1], &p01 = mesh.positions[2], &p11 = mesh.positions[3];
  if (p10 - p00 != p11 - p01) return std::nullopt;
  QuadShape quad{p00, p10 - p00, p01 - p00};
  if (space.flip) {
    quad.o += quad.v;
    quad.v = -quad.v;
  }
  return quad;
}

TriangleShape triangle_shape(const SceneMesh& placed, const LightSpace& space, size_t triangle) {
  const TriangleMesh& mesh = placed.mesh;
  const uint32_t* i = &mesh.indices[triangle * 3];
  TriangleShape t{mesh.positions[i[0]], mesh.positions[i[1]], mesh.positions[i[2]]};
  bool turn = space.flip;
  if (!mesh.normals.empty()) {
    const Vec3d ng = (Vec3d(t.p1) - Vec3d(t.p0)).cross(Vec3d(t.p2) - Vec3d(t.p0));
    turn = (ng.dot(Vec3d(mesh.normals[i[0]] + mesh.normals[i[1]] + mesh.normals[i[2]])) < 0) != space.mirrors;
  }
  if (turn) std::swap(t.p1, t.p2);
  return t;
}

LightShape back_of(const LightShape& shape) {
  struct Back {
    LightShape operator()(QuadShape q) const { q.o += q.v; q.v = -q.v; return q; }
    LightShape operator()(TriangleShape t) const { std::swap(t.p1, t.p2); return t; }
    LightShape operator()(SphereShape s) const { s.inwards = !s.inwards; return s; }
    LightShape operator()(DiskShape d) const { d.n = -d.n; return d; }
    LightShape operator()(CylinderShape c) const { c.inwards = !c.inwards; return c; }
  };
  return std::visit(Back{}, shape);
}

bool is_flat(const LightShape& shape) {
  return std::holds_alternative<QuadShape>(shape) || std::holds_alternative<TriangleShape>(shape);
}

/// pbrt-v4's `power`: radiance such that the light emits that many watts in all.
void scale_to_power(const Params& params, double total_area, int sides, Rgb& radiance) {
  const double watts = params.number("power", 0);
  const double y = 0.2126 * radiance.x + 0.7152 * radiance.y + 0.0722 * radiance.z;
  if (watts > 0 && y > 0) radiance *= float(watts / (kPi * total_area * sides * y));
}

}  // namespace

absl::Status add_area_light(const ShapeEntity& shape, uint32_t mesh, uint32_t instance, const SceneMesh& placed,
                            bool visible, const SceneDescription& description, const SceneFiles& files,
                            LightSet& lights, std::vector<std::string>& warnings) {
  const Entity& entity = description.area_lights[size_t(shape.area_light)];
  Rgb radiance(1);
  if (const Param* l = entity.params.find("L")) {
    ASSIGN_OR_RETURN(radiance, to_rgb(*l, description, files));
  }
  apply_scale(entity.params, radiance);
  if (entity.params.find("filename"))
    warnings.push_back(fmt::format("{}: an image on an area light is rendered as its constant radiance",
                                   description.place(entity.loc)));
  const bool two_sided = entity.params.boolean("twosided", false);
  const int sides = two_sided ? 2 : 1;

  const bool moves = instance != kNone;
  std::optional<AnimatedTransform> motion;
  if (moves) {
    motion = AnimatedTransform::between(shape.placement.start, shape.placement.end, shutter_of(description));
    PENUMBRA_CHECK(motion);  // standing() has refused what cannot move
  }
  const LightSpace space(shape, placed, moves);
  std::optional<LightShape> exact = exact_shape(shape, space);
  if (!exact)
    if (auto quad = as_parallelogram(shape, placed, space)) exact = *quad;
  const size_t n = exact ? 1 : placed.mesh.triangles();
  std::vector<LightShape> shapes;
  shapes.reserve(n);
  if (exact) shapes.push_back(*exact);
  for (size_t t = 0; !exact && t < n; ++t) shapes.push_back(triangle_shape(placed, space, t));
  const auto at_opening = [&](const LightShape& s) { return motion ? moved(s, motion->at(0)) : s; };
  double total_area = 0;
  for (const LightShape& s : shapes) total_area += area(at_opening(s));
  scale_to_power(entity.params, total_area, sides, radiance);
  if (radiance == Rgb(0)) return absl::OkStatus();  // it is a surface, not a light

  lights.by_mesh.resize(mesh + 1);
  lights.by_mesh[mesh] = {uint32_t(lights.area.size()), !exact, two_sided, instance};
  for (size_t s = 0; s < n; ++s) {
    AreaEmitter emitter{at_opening(shapes[s]), radiance, mesh};
    emitter.instance = instance;
    if (motion) emitter.motion = std::make_shared<const LightMotion>(LightMotion{shapes[s], *motion});
    emitter.first_primitive = exact ? 0 : uint32_t(s);
    emitter.primitives = exact ? uint32_t(placed.mesh.triangles()) : 1;
    emitter.flat = is_flat(emitter.shape);
    emitter.invisible = !visible;
    lights.area.push_back(emitter);
    if (two_sided) {
      emitter.shape = back_of(emitter.shape);
      if (motion)
        emitter.motion = std::make_shared<const LightMotion>(LightMotion{back_of(shapes[s]), *motion});
      lights.area.push_back(emitter);
    }
  }
  return absl::OkStatus();
}

}  // namespace penumbra

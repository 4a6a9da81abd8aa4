#include "scenes/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/curve.h"
#include "scenes/mesh_makers.h"

namespace penumbra {
namespace {

struct Maker {
  std::string_view type;
  MeshOr (*make)(const ShapeEntity&, const MeshContext&);
};

constexpr Maker kMakers[] = {
    {"trianglemesh", make_triangle_mesh},
    {"plymesh", make_ply_mesh},
    {"quad", make_quad},
    {"bilinearmesh", make_bilinear_mesh},
    {"loopsubdiv", make_loop_subdivision},
    {"sphere", make_sphere},
    {"disk", make_disk},
    {"cylinder", make_cylinder},
};

/// Curves that are no ribbons are no meshes either.
constexpr Maker kRibbon{"curve", make_ribbon};

const Maker* find_maker(const ShapeEntity& shape) {
  if (has_ribbon(shape)) return &kRibbon;
  for (const Maker& maker : kMakers)
    if (maker.type == shape.type) return &maker;
  return nullptr;
}

bool is_finite(const Vec3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
bool is_finite(const Vec2f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y);
}

template <class T>
absl::Status check_finite(const std::vector<T>& values, std::string_view what, const ShapeEntity& shape,
                          const MeshContext& context) {
  for (size_t i = 0; i < values.size(); ++i)
    if (!is_finite(values[i]))
      return context.error(shape.loc, "{}: the {} of vertex {} is not finite", shape.type, what, i);
  return absl::OkStatus();
}

absl::Status check(const TriangleMesh& mesh, const ShapeEntity& shape, const MeshContext& context) {
  RETURN_IF_ERROR(check_finite(mesh.positions, "position", shape, context));
  RETURN_IF_ERROR(check_finite(mesh.normals, "normal", shape, context));
  RETURN_IF_ERROR(check_finite(mesh.tangents, "tangent", shape, context));
  RETURN_IF_ERROR(check_finite(mesh.uvs, "uv", shape, context));
  const uint32_t highest =
      mesh.indices.empty() ? 0 : *std::max_element(mesh.indices.begin(), mesh.indices.end());
  if (!mesh.indices.empty() && highest >= mesh.positions.size())
    return context.error(shape.loc, "{}: index {} is not below the number of vertices, {}", shape.type,
                         highest, mesh.positions.size());
  return absl::OkStatus();
}

/// Zero area to the accuracy of the vertices' own coordinates: each of the six products of the cross
/// product, and their differences, round once in double.
bool is_degenerate(const Vec3f& p0, const Vec3f& p1, const Vec3f& p2) {
  const Vec3d a = Vec3d(p1) - Vec3d(p0), b = Vec3d(p2) - Vec3d(p0);
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  return a.cross(b).length2() <= kRounding * kRounding * a.length2() * b.length2();
}

void drop_degenerate(TriangleMesh& mesh, const ShapeEntity& shape, const MeshContext& context) {
  const size_t before = mesh.triangles();
  size_t kept = 0;
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    const uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
    if (is_degenerate(mesh.positions[a], mesh.positions[b], mesh.positions[c])) continue;
    mesh.indices[kept] = a;
    mesh.indices[kept + 1] = b;
    mesh.indices[kept + 2] = c;
    kept += 3;
  }
  mesh.indices.resize(kept);
  if (mesh.triangles() != before)
    context.warn(shape.loc, "{}: {} of {} triangles have no area and are left out", shape.type,
                 before - mesh.triangles(), before);
}

}  // namespace

bool has_mesh(const ShapeEntity& shape) {
  return find_maker(shape) != nullptr;
}

absl::StatusOr<TriangleMesh> make_mesh(const ShapeEntity& shape, const SceneDescription& description,
                                       const SceneFiles& files, std::vector<std::string>& warnings) {
  const Maker* const maker = find_maker(shape);
  PENUMBRA_CHECK(maker);
  const MeshContext context{description, files, warnings};
  ASSIGN_OR_RETURN(TriangleMesh mesh, maker->make(shape, context));
  RETURN_IF_ERROR(check(mesh, shape, context));
  drop_degenerate(mesh, shape, context);
  return mesh;
}

}  // namespace penumbra

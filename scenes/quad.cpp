#include "scenes/mesh_makers.h"

namespace penumbra {
namespace {

Vec3d vector_param(const Params& params, std::string_view name, std::string_view type,
                   const Vec3d& fallback) {
  const Param* const param = params.find(name);
  if (!param || param->type != type || param->numbers.size() < 3) return fallback;
  return {param->numbers[0], param->numbers[1], param->numbers[2]};
}

}  // namespace

/// The parallelogram o + s u + t v of SJ19's published code, with texture coordinates (s,t). Its front
/// side, where u × v points, is where the triangles are seen counter-clockwise.
MeshOr make_quad(const ShapeEntity& shape, const MeshContext&) {
  const Vec3d o = vector_param(shape.params, "o", "point3", Vec3d(0, 0, 0));
  const Vec3d u = vector_param(shape.params, "u", "vector3", Vec3d(1, 0, 0));
  const Vec3d v = vector_param(shape.params, "v", "vector3", Vec3d(0, 1, 0));
  TriangleMesh mesh;
  mesh.positions = {Vec3f(o), Vec3f(o + u), Vec3f(o + u + v), Vec3f(o + v)};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

}  // namespace penumbra

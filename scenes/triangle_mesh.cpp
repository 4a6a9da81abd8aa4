#include "scenes/mesh_params.h"

namespace penumbra {

/// "point3 P", "integer indices", and per vertex "normal N", "vector3 S", "point2 uv" (v3: st, float).
MeshOr make_triangle_mesh(const ShapeEntity& shape, const MeshContext& context) {
  TriangleMesh mesh;
  mesh.positions = vectors_of(shape.params, "P", "point3");
  if (mesh.positions.empty()) return context.error(shape.loc, "trianglemesh without \"point3 P\"");
  ASSIGN_OR_RETURN(mesh.indices, indices_of(shape, 3, context));
  if (mesh.indices.empty()) {
    // v4: a single triangle need not number its corners.
    if (mesh.positions.size() != 3)
      return context.error(shape.loc, "trianglemesh without \"integer indices\"");
    mesh.indices = {0, 1, 2};
  }
  mesh.normals = vectors_of(shape.params, "N", "normal");
  mesh.tangents = vectors_of(shape.params, "S", "vector3");
  mesh.uvs = uvs_of(shape.params, {"uv", "st"});
  fit_to_vertices(mesh.normals, mesh.positions.size(), "N", shape, context);
  fit_to_vertices(mesh.tangents, mesh.positions.size(), "S", shape, context);
  fit_to_vertices(mesh.uvs, mesh.positions.size(), "uv", shape, context);
  return mesh;
}

}  // namespace penumbra

#pragma once
// Arrays of a shape's parameters as the mesh's vectors.
#include <initializer_list>

#include "scenes/mesh_makers.h"

namespace penumbra {

/// "point3 P", "normal N", "vector3 S"; empty if absent or of another type.
std::vector<Vec3f> vectors_of(const Params& params, std::string_view name, std::string_view type);

/// The first of these names that is given as point2 or as floats (pbrt-v3's "float uv" and "float st").
std::vector<Vec2f> uvs_of(const Params& params, std::initializer_list<std::string_view> names);

/// "integer indices" in groups of `group`; empty if absent. InvalidArgument for a negative index or an
/// incomplete group.
absl::StatusOr<std::vector<uint32_t>> indices_of(const ShapeEntity& shape, size_t group,
                                                 const MeshContext& context);

/// An array per vertex that is shorter than the positions is ignored, one that is longer is cut, with a
/// warning (as pbrt does).
template <class T>
void fit_to_vertices(std::vector<T>& values, size_t vertices, std::string_view name, const ShapeEntity& shape,
                     const MeshContext& context) {
  if (values.empty() || values.size() == vertices) return;
  const bool enough = values.size() > vertices;
  context.warn(shape.loc, "{} values of {} for {} vertices: {}", values.size(), name, vertices,
               enough ? "the rest is left out" : "all left out");
  values.resize(enough ? vertices : 0);
}

}  // namespace penumbra

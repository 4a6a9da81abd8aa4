#pragma once
// Triangle meshes in object space, from the description's shapes: trianglemesh, plymesh, quad,
// bilinearmesh, loopsubdiv, and the tessellated quadrics (sphere, disk, cylinder).
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/files.h"

namespace penumbra {

/// Arrays are per vertex and either empty or as long as positions; indices by threes.
struct TriangleMesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
  std::vector<Vec3f> tangents;
  std::vector<Vec2f> uvs;
  std::vector<uint32_t> indices;
  size_t triangles() const { return indices.size() / 3; }
};

/// True for the shape types that make_mesh can turn into triangles.
bool has_mesh(const ShapeEntity& shape);

/// Object-space mesh of a shape. Degenerate (zero-area) triangles are dropped and counted in a warning.
/// InvalidArgument (`file:line:column: …`) for a missing or lying file, an index out of range, a value
/// that is not finite or out of range.
absl::StatusOr<TriangleMesh> make_mesh(const ShapeEntity& shape, const SceneDescription& description,
                                       const SceneFiles& files, std::vector<std::string>& warnings);

}  // namespace penumbra

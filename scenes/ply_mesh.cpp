#include "scenes/mesh_makers.h"
#include "scenes/ply.h"
#include "scenes/read_file.h"

namespace penumbra {

/// "string filename": see ply.h.
MeshOr make_ply_mesh(const ShapeEntity& shape, const MeshContext& context) {
  const std::string name = shape.params.string("filename", "");
  const auto fault = [&](const absl::Status& status) {
    return context.error(shape.loc, "plymesh '{}': {}", printable(name), message_of(status));
  };
  const absl::StatusOr<std::string> path = context.files.path_of(name);
  if (!path.ok()) return fault(path.status());
  const absl::StatusOr<std::string> bytes = read_file(*path);
  if (!bytes.ok()) return fault(bytes.status());
  absl::StatusOr<PlyMesh> ply = read_ply(*bytes);
  if (!ply.ok()) return fault(ply.status());
  if (ply->short_faces != 0)
    context.warn(shape.loc, "plymesh '{}': {} faces of fewer than 3 vertices left out", printable(name),
                 ply->short_faces);
  return std::move(ply->mesh);
}

}  // namespace penumbra

#pragma once
// Meshes from PLY files: ascii, little and big endian; triangles, quads and polygons (as fans); normals
// nx ny nz; texture coordinates u v, s t, texture_u texture_v or texture_s texture_t. Other elements and
// properties are skipped.
#include <string_view>

#include "absl/status/statusor.h"
#include "scenes/mesh.h"

namespace penumbra {

struct PlyMesh {
  TriangleMesh mesh;
  size_t short_faces = 0;  ///< faces of fewer than three vertices, left out
};

/// The whole content of a file, unpacked. InvalidArgument says what and where; every index is below the
/// number of vertices. Memory is bounded by a small multiple of the bytes, whatever the header says.
absl::StatusOr<PlyMesh> read_ply(std::string_view bytes);

/// Can the file at `path` be what its header says? Reads its beginning only.
absl::Status check_ply_file(const std::string& path);

}  // namespace penumbra

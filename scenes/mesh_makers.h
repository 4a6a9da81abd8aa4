#pragma once
// One maker per shape type, each in its own file. A maker returns the mesh as the scene has it; make_mesh
// (mesh.cpp) then checks indices and values and drops degenerate triangles, for all of them alike.
#include <string>
#include <vector>

#include "scenes/diagnostics.h"
#include "scenes/mesh.h"

namespace penumbra {

/// What a maker needs beside its shape.
struct MeshContext {
  const SceneDescription& description;
  const SceneFiles& files;
  std::vector<std::string>& warnings;

  template <class... Args>
  absl::Status error(FileLoc loc, fmt::format_string<Args...> text, Args&&... args) const {
    return invalid_input("{}: {}", description.place(loc), fmt::format(text, std::forward<Args>(args)...));
  }
  template <class... Args>
  void warn(FileLoc loc, fmt::format_string<Args...> text, Args&&... args) const {
    warnings.push_back(
        fmt::format("{}: {}", description.place(loc), fmt::format(text, std::forward<Args>(args)...)));
  }
};

using MeshOr = absl::StatusOr<TriangleMesh>;

MeshOr make_triangle_mesh(const ShapeEntity& shape, const MeshContext& context);
MeshOr make_ply_mesh(const ShapeEntity& shape, const MeshContext& context);
MeshOr make_quad(const ShapeEntity& shape, const MeshContext& context);
MeshOr make_bilinear_mesh(const ShapeEntity& shape, const MeshContext& context);
MeshOr make_loop_subdivision(const ShapeEntity& shape, const MeshContext& context);
MeshOr make_sphere(const ShapeEntity& shape, const MeshContext& context);
MeshOr make_disk(const ShapeEntity& shape, const MeshContext& context);
MeshOr make_cylinder(const ShapeEntity& shape, const MeshContext& context);
MeshOr make_ribbon(const ShapeEntity& shape, const MeshContext& context);

}  // namespace penumbra

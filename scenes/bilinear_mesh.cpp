// pbrt-v4's bilinear patches, each as triangles.
#include <cmath>
#include <limits>

#include "scenes/mesh_params.h"

namespace penumbra {
namespace {

// A curved patch becomes kSteps × kSteps cells. Within a cell the patch leaves its two triangles by at
// most |p00 - p10 - p01 + p11| / (4 kSteps²): 1/1024 of how far the corners are from a parallelogram.
constexpr uint32_t kSteps = 16;

/// Corners in pbrt's order: (u,v) = (0,0) (1,0) (0,1) (1,1).
struct Patch {
  uint32_t corner[4];
};

template <class T>
T lerp(const T& a, const T& b, float t) {
  return a * (1 - t) + b * t;
}

template <class T>
T bilerp(const std::vector<T>& values, const Patch& patch, float u, float v) {
  return lerp(lerp(values[patch.corner[0]], values[patch.corner[1]], u),
              lerp(values[patch.corner[2]], values[patch.corner[3]], u), v);
}

bool is_flat(const TriangleMesh& in, const Patch& patch) {
  const Vec3d p00(in.positions[patch.corner[0]]);
  const Vec3d a = Vec3d(in.positions[patch.corner[1]]) - p00, b = Vec3d(in.positions[patch.corner[2]]) - p00,
              c = Vec3d(in.positions[patch.corner[3]]) - p00;
  // The corners are floats: a volume below the rounding of one coordinate is flat.
  constexpr double kRounding = 4 * std::numeric_limits<float>::epsilon();
  return std::abs(a.cross(b).dot(c)) <= kRounding * a.length() * b.length() * c.length();
}

uint32_t add_vertex(const TriangleMesh& in, const Patch& patch, float u, float v, TriangleMesh& out) {
  const auto index = static_cast<uint32_t>(out.positions.size());
  out.positions.push_back(bilerp(in.positions, patch, u, v));
  out.uvs.push_back(in.uvs.empty() ? Vec2f(u, v) : bilerp(in.uvs, patch, u, v));
  if (!in.normals.empty()) out.normals.push_back(bilerp(in.normals, patch, u, v).normalized());
  return index;
}

void add_patch(const TriangleMesh& in, const Patch& patch, TriangleMesh& out) {
  const uint32_t steps = is_flat(in, patch) ? 1 : kSteps;
  const auto first = static_cast<uint32_t>(out.positions.size());
  const auto step = static_cast<float>(steps);
  for (uint32_t j = 0; j <= steps; ++j)
    for (uint32_t i = 0; i <= steps; ++i)
      add_vertex(in, patch, static_cast<float>(i) / step, static_cast<float>(j) / step, out);
  for (uint32_t j = 0; j < steps; ++j)
    for (uint32_t i = 0; i < steps; ++i) {
      const uint32_t p00 = first + j * (steps + 1) + i, p10 = p00 + 1, p01 = p00 + steps + 1, p11 = p01 + 1;
      out.indices.insert(out.indices.end(), {p00, p10, p11, p00, p11, p01});  // towards ∂p/∂u × ∂p/∂v
    }
}

}  // namespace

/// "point3 P" and "integer indices", four per patch (none: one patch); "normal N", "point2 uv". A patch
/// whose corners lie in a plane is two triangles.
MeshOr make_bilinear_mesh(const ShapeEntity& shape, const MeshContext& context) {
  TriangleMesh in;
  in.positions = vectors_of(shape.params, "P", "point3");
  if (in.positions.empty()) return context.error(shape.loc, "bilinearmesh without \"point3 P\"");
  ASSIGN_OR_RETURN(in.indices, indices_of(shape, 4, context));
  if (in.indices.empty()) {
    if (in.positions.size() != 4) return context.error(shape.loc, "bilinearmesh without \"integer indices\"");
    in.indices = {0, 1, 2, 3};
  }
  for (const uint32_t index : in.indices)
    if (index >= in.positions.size())
      return context.error(shape.loc, "index {} is not below the number of vertices, {}", index,
                           in.positions.size());
  in.normals = vectors_of(shape.params, "N", "normal");
  in.uvs = uvs_of(shape.params, {"uv", "st"});
  fit_to_vertices(in.normals, in.positions.size(), "N", shape, context);
  fit_to_vertices(in.uvs, in.positions.size(), "uv", shape, context);
  TriangleMesh out;
  for (size_t i = 0; i < in.indices.size(); i += 4)
    add_patch(in, {{in.indices[i], in.indices[i + 1], in.indices[i + 2], in.indices[i + 3]}}, out);
  return out;
}

}  // namespace penumbra

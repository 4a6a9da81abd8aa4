#include "worker/geometry/triangle_pairs.h"

#include <Imath/ImathBox.h>

#include <optional>

namespace penumbra {
namespace {

const uint32_t* vertices_of(const TriangleMesh& mesh, uint32_t triangle) {
  return &mesh.indices[3 * size_t{triangle}];
}

/// An edge of two triangles: vertex i of the first is vertex j of the second, twice.
struct SharedEdge {
  int i[2], j[2];
};

/// None if the triangles share fewer or more than two positions, or one of them has a position twice.
std::optional<SharedEdge> shared_edge(const TriangleMesh& mesh, uint32_t first, uint32_t second) {
  const uint32_t *a = vertices_of(mesh, first), *b = vertices_of(mesh, second);
  SharedEdge edge{};
  int found = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      // Seams of normals or texture coordinates have a position under two indices.
      if (a[i] != b[j] && mesh.positions[a[i]] != mesh.positions[b[j]]) continue;
      if (found == 2) return std::nullopt;
      edge.i[found] = i;
      edge.j[found++] = j;
    }
  }
  if (found != 2 || edge.i[0] == edge.i[1] || edge.j[0] == edge.j[1]) return std::nullopt;
  return edge;
}

Imath::Box3f bounds_of(const TriangleMesh& mesh, uint32_t triangle) {
  Imath::Box3f box;
  const uint32_t* v = vertices_of(mesh, triangle);
  for (int c = 0; c < 3; ++c) box.extendBy(mesh.positions[v[c]]);
  return box;
}

double half_area(const Imath::Box3f& box) {
  const Vec3d d = Vec3d(box.max) - Vec3d(box.min);
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

/// A box is visited about as often as its area says: together they must not be visited more often than apart.
bool together_smaller(const TriangleMesh& mesh, uint32_t first, uint32_t second) {
  const Imath::Box3f a = bounds_of(mesh, first), b = bounds_of(mesh, second);
  Imath::Box3f both = a;
  both.extendBy(b);
  return half_area(both) <= half_area(a) + half_area(b);
}

}  // namespace

void append_pairs(const TriangleMesh& mesh, std::vector<TrianglePair>& pairs) {
  const uint32_t count = mesh.triangles();
  for (uint32_t i = 0; i < count; ++i) {
    const bool paired = i + 1 < count && shared_edge(mesh, i, i + 1) && together_smaller(mesh, i, i + 1);
    pairs.push_back({i, paired ? i + 1 : i});
    i += paired;
  }
}

PairCorners corners_of(const TriangleMesh& mesh, const TrianglePair& pair) {
  const uint32_t* a = vertices_of(mesh, pair.first);
  constexpr uint8_t kInOrder = 0 | 1 << 2 | 2 << 4;
  if (pair.alone()) return {{a[0], a[1], a[2], a[0]}, {kInOrder, kInOrder}};
  const uint32_t* b = vertices_of(mesh, pair.second);
  const SharedEdge edge = *shared_edge(mesh, pair.first, pair.second);
  const int own[2] = {3 - edge.i[0] - edge.i[1], 3 - edge.j[0] - edge.j[1]};
  PairCorners corners{{a[edge.i[0]], a[edge.i[1]], a[own[0]], b[own[1]]}, {}};
  for (int end = 0; end < 2; ++end) {
    corners.order[0] |= static_cast<uint8_t>(end << 2 * edge.i[end]);
    corners.order[1] |= static_cast<uint8_t>(end << 2 * edge.j[end]);
  }
  corners.order[0] |= static_cast<uint8_t>(2 << 2 * own[0]);
  corners.order[1] |= static_cast<uint8_t>(3 << 2 * own[1]);
  return corners;
}

}  // namespace penumbra

// C. Loop, Smooth Subdivision Surfaces Based on Triangles (1987), with Warren's weights, the limit positions
// and tangents of Hoppe et al., Piecewise Smooth Surface Reconstruction (1994), as pbrt-v3 §3.8 uses them.
#include <cmath>
#include <numbers>

#include "scenes/half_edges.h"
#include "scenes/mesh_params.h"

namespace penumbra {
namespace {

// 64 million triangles: beyond it a level too many was asked for, and memory would be gone.
constexpr uint64_t kMostTriangles = uint64_t{1} << 26;

/// Weight of each neighbour of an interior vertex (Warren); 1/16 at the regular valence 6.
double beta(size_t valence) {
  return valence == 3 ? 3.0 / 16 : 3.0 / (8.0 * static_cast<double>(valence));
}

/// The same for the position on the limit surface.
double limit_weight(size_t valence) {
  return 1 / (static_cast<double>(valence) + 3 / (8 * beta(valence)));
}

/// Neighbours of one vertex in turn. Interior: clockwise where faces wind counter-clockwise; boundary:
/// counter-clockwise from one boundary edge to the other. (pbrt's orders: they decide which way S × T
/// points.)
struct Ring {
  std::vector<uint32_t> vertices;
  bool boundary = false;
};

struct LoopMesh {
  std::vector<Vec3d> positions;
  std::vector<uint32_t> indices;  ///< vertex at the start of each half-edge
  std::vector<uint32_t> opposite;
  std::vector<uint32_t> corner_of;  ///< one half-edge that starts at each vertex; kNoHalfEdge: unused

  void ring(uint32_t vertex, Ring& out) const;
  LoopMesh subdivided() const;

 private:
  std::vector<Vec3d> moved_vertices() const;
  void add_edge_vertices(LoopMesh& out, std::vector<uint32_t>& edge_vertex) const;
  Vec3d edge_point(uint32_t half_edge) const;
  void add_children(uint32_t face, const std::vector<uint32_t>& edge_vertex, LoopMesh& out) const;
};

void LoopMesh::ring(uint32_t vertex, Ring& out) const {
  out.vertices.clear();
  const uint32_t start = corner_of[vertex];
  uint32_t h = start;
  // Clockwise: across the edge that leaves the vertex. opposite is an involution, so this ends where it
  // began or at a boundary.
  do {
    out.vertices.push_back(indices[next_half_edge(h)]);
    if (opposite[h] == kNoHalfEdge) break;
    h = next_half_edge(opposite[h]);
  } while (h != start);
  out.boundary = opposite[h] == kNoHalfEdge;
  if (!out.boundary) return;
  out.vertices = {indices[next_half_edge(h)]};
  while (h != kNoHalfEdge) {
    out.vertices.push_back(indices[previous_half_edge(h)]);
    h = opposite[previous_half_edge(h)];
  }
}

/// (1 - n w) p + w (sum of the ring), or of its two ends at a boundary.
Vec3d weighted(const std::vector<Vec3d>& positions, uint32_t vertex, const Ring& ring, double weight) {
  if (ring.boundary)
    return positions[vertex] * (1 - 2 * weight) +
           (positions[ring.vertices.front()] + positions[ring.vertices.back()]) * weight;
  Vec3d sum(0);
  for (const uint32_t neighbour : ring.vertices) sum += positions[neighbour];
  return positions[vertex] * (1 - static_cast<double>(ring.vertices.size()) * weight) + sum * weight;
}

std::vector<Vec3d> LoopMesh::moved_vertices() const {
  std::vector<Vec3d> moved = positions;
  Ring around;
  for (uint32_t v = 0; v < moved.size(); ++v) {
    if (corner_of[v] == kNoHalfEdge) continue;
    ring(v, around);
    moved[v] = weighted(positions, v, around, around.boundary ? 1.0 / 8 : beta(around.vertices.size()));
  }
  return moved;
}

Vec3d LoopMesh::edge_point(uint32_t h) const {
  const Vec3d ends = positions[indices[h]] + positions[indices[next_half_edge(h)]];
  if (opposite[h] == kNoHalfEdge) return ends * 0.5;
  const Vec3d sides =
      positions[indices[previous_half_edge(h)]] + positions[indices[previous_half_edge(opposite[h])]];
  return ends * (3.0 / 8) + sides * (1.0 / 8);
}

void LoopMesh::add_edge_vertices(LoopMesh& out, std::vector<uint32_t>& edge_vertex) const {
  for (uint32_t h = 0; h < indices.size(); ++h) {
    const uint32_t other = opposite[h];
    if (other != kNoHalfEdge && other < h) {
      edge_vertex[h] = edge_vertex[other];
      continue;
    }
    edge_vertex[h] = static_cast<uint32_t>(out.positions.size());
    out.positions.push_back(edge_point(h));
    out.corner_of.push_back(3 * (4 * (h / 3) + h % 3) + 1);
  }
}

/// Children of face f: 4f+k at corner k with vertices (v_k, e_k, e_{k-1}); 4f+3 in the middle with
/// (e_0, e_1, e_2); e_k halves the edge k. Their opposites follow from the parents'.
void LoopMesh::add_children(uint32_t f, const std::vector<uint32_t>& edge_vertex, LoopMesh& out) const {
  const auto child = [](uint32_t h) { return 3 * (4 * (h / 3) + h % 3); };  // its first half-edge
  const uint32_t middle = 3 * (4 * f + 3);
  for (uint32_t k = 0; k < 3; ++k) {
    const uint32_t h = 3 * f + k, before = previous_half_edge(h), c = child(h);
    out.indices[c] = indices[h];
    out.indices[c + 1] = edge_vertex[h];
    out.indices[c + 2] = edge_vertex[before];
    out.indices[middle + k] = edge_vertex[h];
    out.opposite[c + 1] = middle + before % 3;
    out.opposite[middle + before % 3] = c + 1;
    // v_k → e_k is half of edge h; e_{k-1} → v_k is half of the edge before it.
    out.opposite[c] = opposite[h] == kNoHalfEdge ? kNoHalfEdge : child(next_half_edge(opposite[h])) + 2;
    out.opposite[c + 2] = opposite[before] == kNoHalfEdge ? kNoHalfEdge : child(opposite[before]);
  }
}

LoopMesh LoopMesh::subdivided() const {
  LoopMesh out;
  out.positions = moved_vertices();
  out.corner_of.resize(positions.size());
  for (size_t v = 0; v < positions.size(); ++v) {
    const uint32_t h = corner_of[v];
    out.corner_of[v] = h == kNoHalfEdge ? h : 3 * (4 * (h / 3) + h % 3);
  }
  out.indices.resize(4 * indices.size());
  out.opposite.resize(4 * indices.size());
  std::vector<uint32_t> edge_vertex(indices.size());
  add_edge_vertices(out, edge_vertex);
  for (uint32_t f = 0; f < indices.size() / 3; ++f) add_children(f, edge_vertex, out);
  return out;
}

/// Tangents of the limit surface; their cross product is pbrt's normal, against the faces' winding.
Vec3d limit_normal(const std::vector<Vec3d>& p, uint32_t vertex, const Ring& ring) {
  const std::vector<uint32_t>& r = ring.vertices;
  const size_t n = r.size();
  Vec3d s(0), t(0);
  if (!ring.boundary) {
    for (size_t k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
      s += p[r[k]] * std::cos(angle);
      t += p[r[k]] * std::sin(angle);
    }
    return s.cross(t);
  }
  s = p[r[n - 1]] - p[r[0]];
  if (n == 2)
    t = p[r[0]] + p[r[1]] - p[vertex] * 2;
  else if (n == 3)
    t = p[r[1]] - p[vertex];
  else if (n == 4)
    t = p[r[1]] * 2 + p[r[2]] * 2 - p[r[0]] - p[r[3]] - p[vertex] * 2;
  else {
    const double angle = std::numbers::pi / static_cast<double>(n - 1);
    t = (p[r[0]] + p[r[n - 1]]) * -std::sin(angle);
    for (size_t k = 1; k + 1 < n; ++k)
      t -= p[r[k]] * ((2 * std::cos(angle) - 2) * std::sin(static_cast<double>(k) * angle));
  }
  return s.cross(t);
}

/// Vertices pushed to the limit surface, their normals, and triangles that wind as the normals say.
TriangleMesh limit_mesh(const LoopMesh& loop) {
  TriangleMesh mesh;
  const size_t count = loop.positions.size();
  std::vector<Vec3d> limit = loop.positions;
  Ring ring;
  for (uint32_t v = 0; v < count; ++v) {
    if (loop.corner_of[v] == kNoHalfEdge) continue;
    loop.ring(v, ring);
    limit[v] =
        weighted(loop.positions, v, ring, ring.boundary ? 1.0 / 5 : limit_weight(ring.vertices.size()));
  }
  mesh.positions.reserve(count);
  mesh.normals.reserve(count);
  for (uint32_t v = 0; v < count; ++v) {
    mesh.positions.emplace_back(limit[v]);
    if (loop.corner_of[v] != kNoHalfEdge) loop.ring(v, ring);
    const Vec3d normal = loop.corner_of[v] == kNoHalfEdge ? Vec3d(0) : limit_normal(limit, v, ring);
    mesh.normals.emplace_back(normal.normalized());
  }
  mesh.indices = loop.indices;
  for (size_t i = 0; i < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
  return mesh;
}

absl::Status check_levels(const ShapeEntity& shape, int64_t levels, uint64_t triangles,
                          const MeshContext& context) {
  if (levels < 0) return context.error(shape.loc, "loopsubdiv: {} levels", levels);
  for (int64_t level = 0; level < levels; ++level)
    if ((triangles *= 4) > kMostTriangles)
      return context.error(shape.loc, "loopsubdiv: {} levels make more than {} triangles", levels,
                           kMostTriangles);
  return absl::OkStatus();
}

}  // namespace

/// "point3 P", "integer indices", "integer levels" (or nlevels; 3).
MeshOr make_loop_subdivision(const ShapeEntity& shape, const MeshContext& context) {
  LoopMesh loop;
  for (const Vec3f& p : vectors_of(shape.params, "P", "point3")) loop.positions.emplace_back(p);
  ASSIGN_OR_RETURN(loop.indices, indices_of(shape, 3, context));
  if (loop.positions.empty() || loop.indices.empty())
    return context.error(shape.loc, "loopsubdiv needs \"point3 P\" and \"integer indices\"");
  loop.corner_of.assign(loop.positions.size(), kNoHalfEdge);
  for (uint32_t h = 0; h < loop.indices.size(); ++h) {
    if (loop.indices[h] >= loop.positions.size())
      return context.error(shape.loc, "index {} is not below the number of vertices, {}", loop.indices[h],
                           loop.positions.size());
    loop.corner_of[loop.indices[h]] = h;
  }
  const int64_t levels = shape.params.integer("levels", shape.params.integer("nlevels", 3));
  RETURN_IF_ERROR(check_levels(shape, levels, loop.indices.size() / 3, context));
  auto opposite = opposite_half_edges(loop.indices);
  if (!opposite.ok()) return context.error(shape.loc, "loopsubdiv: {}", message_of(opposite.status()));
  loop.opposite = *std::move(opposite);
  for (int64_t level = 0; level < levels; ++level) loop = loop.subdivided();
  return limit_mesh(loop);
}

}  // namespace penumbra

#include "scenes/half_edges.h"

#include <algorithm>
#include <tuple>

#include "proto/status.h"

namespace penumbra {

absl::StatusOr<std::vector<uint32_t>> opposite_half_edges(std::span<const uint32_t> indices) {
  struct Edge {
    uint32_t low, high, half_edge;
  };
  std::vector<Edge> edges;
  edges.reserve(indices.size());
  for (uint32_t h = 0; h < indices.size(); ++h) {
    const uint32_t a = indices[h], b = indices[next_half_edge(h)];
    edges.push_back({std::min(a, b), std::max(a, b), h});
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return std::tie(x.low, x.high, x.half_edge) < std::tie(y.low, y.high, y.half_edge);
  });
  std::vector<uint32_t> opposite(indices.size(), kNoHalfEdge);
  for (size_t i = 0; i < edges.size();) {
    size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    const Edge& first = edges[i];
    if (end - i > 2) return invalid_input("{} faces meet at the edge {}–{}", end - i, first.low, first.high);
    if (end - i == 2) {
      const Edge& second = edges[i + 1];
      if (indices[first.half_edge] == indices[second.half_edge])
        return invalid_input("the faces at the edge {}–{} wind against each other", first.low, first.high);
      opposite[first.half_edge] = second.half_edge;
      opposite[second.half_edge] = first.half_edge;
    }
    i = end;
  }
  return opposite;
}

}  // namespace penumbra

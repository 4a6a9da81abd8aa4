#pragma once
// Connectivity of a triangle mesh. Half-edge 3f+k runs from corner k of face f to the next corner; it also
// stands for the corner it starts at.
#include <cstdint>
#include <span>
#include <vector>

#include "absl/status/statusor.h"

namespace penumbra {

constexpr uint32_t kNoHalfEdge = ~uint32_t{0};

constexpr uint32_t next_half_edge(uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
constexpr uint32_t previous_half_edge(uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}

/// Per half-edge the one of the other face that runs the other way; kNoHalfEdge at a boundary.
/// InvalidArgument if an edge has more than two faces or two that wind against each other.
absl::StatusOr<std::vector<uint32_t>> opposite_half_edges(std::span<const uint32_t> indices);

}  // namespace penumbra

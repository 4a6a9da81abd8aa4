#pragma once
// Neighbouring triangles, two by two. Most meshes list the two halves of a quad one after the other: together
// they have four corners instead of six, and what they hide of a fan is mostly one interval.
#include <cstdint>
#include <vector>

#include "scenes/mesh.h"

namespace penumbra {

/// Two triangles of a mesh, or one.
struct TrianglePair {
  uint32_t first = 0, second = 0;
  bool alone() const { return first == second; }
};

/// Corners of a pair: 0 and 1 are the ends of the shared edge, 2 belongs to the first triangle alone, 3 to
/// the second one. A triangle alone has corner 3 = corner 0.
struct PairCorners {
  uint32_t index[4];  ///< into the mesh's positions
  uint8_t order[2];   ///< which corner each triangle's vertices are: two bits each, the first one's lowest
};

/// All triangles of a mesh, each in one pair. Neighbours in the list that have an edge in common, at equal
/// positions, go together, unless the box around both is larger in area than their own boxes are.
void append_pairs(const TriangleMesh& mesh, std::vector<TrianglePair>& pairs);

/// Corners of a pair that append_pairs() made.
PairCorners corners_of(const TriangleMesh& mesh, const TrianglePair& pair);

}  // namespace penumbra

#include "worker/geometry/triangle_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/geometry/random_scenes.h"

namespace penumbra::testing {
namespace {

std::vector<TrianglePair> pairs_of(const TriangleMesh& mesh) {
  std::vector<TrianglePair> pairs;
  append_pairs(mesh, pairs);
  return pairs;
}

/// A strip of unit squares along x, each cut into two triangles that list the same corners.
TriangleMesh strip(uint32_t squares) {
  TriangleMesh mesh;
  for (uint32_t i = 0; i <= squares; ++i) {
    mesh.positions.push_back(Vec3f(static_cast<float>(i), 0, 0));
    mesh.positions.push_back(Vec3f(static_cast<float>(i), 1, 0));
  }
  for (uint32_t i = 0; i < squares; ++i) {
    const uint32_t o = 2 * i;
    for (const uint32_t corner : {o, o + 2, o + 1, o + 1, o + 2, o + 3}) mesh.indices.push_back(corner);
  }
  return mesh;
}

/// Each triangle's vertices, as a pair's corners and their order say.
void expect_vertices(const TriangleMesh& mesh, const TrianglePair& pair) {
  const PairCorners corners = corners_of(mesh, pair);
  for (int which = 0; which < 2; ++which) {
    const uint32_t triangle = which == 0 ? pair.first : pair.second;
    for (int c = 0; c < 3; ++c) {
      const uint32_t corner = corners.index[corners.order[which] >> 2 * c & 3];
      EXPECT_EQ(mesh.positions[corner], mesh.positions[mesh.indices[3 * size_t{triangle} + c]])
          << "triangle " << triangle << ", vertex " << c;
    }
  }
}

TEST(TrianglePairs, HalvesOfSquaresGoTogether) {
  const TriangleMesh mesh = strip(5);
  const std::vector<TrianglePair> pairs = pairs_of(mesh);
  ASSERT_EQ(pairs.size(), 5u);
  for (uint32_t i = 0; i < 5; ++i) {
    EXPECT_EQ(pairs[i].first, 2 * i);
    EXPECT_EQ(pairs[i].second, 2 * i + 1);
    expect_vertices(mesh, pairs[i]);
  }
}

TEST(TrianglePairs, EveryTriangleIsInOnePairWithItsOwnVertices) {
  for (const TriangleMesh& mesh : {soup(41, 0.5f, 1), loose_pairs(50, 0.5f, 2), ball({0, 0, 0}, 1, 7)}) {
    std::vector<uint32_t> seen;
    for (const TrianglePair& pair : pairs_of(mesh)) {
      seen.push_back(pair.first);
      if (!pair.alone()) seen.push_back(pair.second);
      expect_vertices(mesh, pair);
    }
    std::sort(seen.begin(), seen.end());
    ASSERT_EQ(seen.size(), mesh.triangles());
    for (uint32_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], i);
  }
}

TEST(TrianglePairs, PositionsCountAndNotIndices) {
  TriangleMesh mesh = strip(1);
  for (size_t i = 3; i < 6; ++i) {  // a seam: the second triangle has vertices of its own
    mesh.positions.push_back(mesh.positions[mesh.indices[i]]);
    mesh.indices[i] = static_cast<uint32_t>(mesh.positions.size() - 1);
  }
  ASSERT_EQ(pairs_of(mesh).size(), 1u);
  expect_vertices(mesh, pairs_of(mesh)[0]);
}

TEST(TrianglePairs, WhatIsNotHalfOfAPairStaysAlone) {
  EXPECT_EQ(pairs_of(soup(2, 0.5f, 3)).size(), 2u) << "nothing in common";
  TriangleMesh twice = strip(1);
  std::copy_n(twice.indices.begin(), 3, twice.indices.begin() + 3);
  EXPECT_EQ(pairs_of(twice).size(), 2u) << "the same triangle again has three positions in common";
  TriangleMesh collapsed = strip(1);
  collapsed.indices[5] = collapsed.indices[3];
  EXPECT_EQ(pairs_of(collapsed).size(), 2u) << "two of its vertices are one";
  TriangleMesh roof = strip(1);
  roof.positions[0] = Vec3f(0, 0, 5);
  roof.positions[3] = Vec3f(6, 1, 0);
  EXPECT_EQ(pairs_of(roof).size(), 2u) << "the box around both is larger than theirs";
}

}  // namespace
}  // namespace penumbra::testing

#pragma once
// The leaves of the line hierarchy: triangles two by two (triangle_pairs.h), sixteen pairs to a block.
#include <array>
#include <cstdint>

#include "worker/geometry/geometry.h"

namespace penumbra {

constexpr int kWidth = 16;
constexpr int kTrianglesPerBlock = 2 * kWidth;

/// A range of triangle numbers that never hide (the light's own surface).
struct Excluded {
  uint32_t first = 0, count = 0;
  bool holds(uint32_t id) const { return id - first < count; }
};

/// A lane holds two triangles that share an edge. A triangle that is alone has its first corner again as the
/// last one, so that its pair is a triangle without area. Unused lanes are points, which no plane cuts.
struct alignas(64) PairBlock {
  float p[4][3][kWidth];  ///< [corner][axis]: 0 and 1 are the shared edge's; 2 is the first triangle's, 3 the
                          ///< second's
  uint32_t id[2][kWidth];  ///< of the triangles, in LineBvh::first_triangle's numbering; kNone: there is none
  uint8_t order[2]
               [kWidth];  ///< which corners a triangle's vertices are: two bits each, the first one's lowest

  uint32_t first_id, last_id;  ///< least and greatest number here
  int32_t lanes;               ///< used ones; they come first

  bool may_hold(const Excluded& e) const { return first_id < e.first + e.count && e.first <= last_id; }
  bool has(int lane, int which) const { return id[which][lane] != kNone; }
  Vec3f corner(int lane, int c) const { return {p[c][0][lane], p[c][1][lane], p[c][2][lane]}; }
  /// Vertices of a lane's first or second triangle, in the scene's order.
  std::array<Vec3f, 3> triangle(int lane, int which) const {
    const int corners = order[which][lane];
    return {corner(lane, corners & 3), corner(lane, corners >> 2 & 3), corner(lane, corners >> 4)};
  }
  /// Which vertex of a triangle is a corner of its pair.
  int vertex_of(int lane, int which, int c) const {
    const int corners = order[which][lane];
    return (corners & 3) == c ? 0 : (corners >> 2 & 3) == c ? 1 : 2;
  }
  /// use(vertices, number)
  template <class Use>
  void for_each_triangle(Use use) const {
    for (int lane = 0; lane < kWidth; ++lane)
      for (int which = 0; which < 2; ++which)
        if (has(lane, which)) use(triangle(lane, which), id[which][lane]);
  }

  void copy(int lane, const PairBlock& from, int from_lane);
  /// Drops the other triangle of a lane; the one kept is its first one then.
  void keep_one(int lane, int which);
  /// After the first `used` lanes, at least one, are set: leaves the others unused.
  void finish(int used);
};

}  // namespace penumbra

#pragma once
// What a shaft keeps: its planes, and the triangles that can hide something of the light.
#include "worker/geometry/aligned.h"
#include "worker/geometry/line_bvh.h"
#include "worker/geometry/line_query.h"
#include "worker/geometry/shaft_planes.h"

namespace penumbra {

/// Triangles in the order found, packed into blocks; two that are a pair stay together.
class ShaftList {
 public:
  /// More than these and single line queries, which stop at what is hidden already, are the cheaper way
  /// (README: measured).
  static constexpr int kMost = 32;

  void clear() { lanes_ = triangles_ = 0; }
  int size() const { return triangles_; }
  /// Of a block's lane the first triangle, the second, or both. Not beyond kMost triangles.
  void add(const PairBlock& block, int lane, bool first, bool second);
  /// Unused lanes of the last block become points, which no plane cuts.
  void finish();
  std::span<const PairBlock> blocks() const {
    return {blocks_, static_cast<size_t>((lanes_ + kWidth - 1) / kWidth)};
  }
  /// i < size()
  std::array<Vec3f, 3> triangle(int i) const {
    return blocks_[places_[i].lane / kWidth].triangle(places_[i].lane % kWidth, places_[i].which);
  }

 private:
  struct Place {
    uint8_t lane, which;
  };
  int lanes_ = 0, triangles_ = 0;
  PairBlock blocks_[kMost / kWidth];
  Place places_[kMost];
};

struct Shaft::Parts {
  ShaftPlanes planes;
  ShaftList list;
  /// A triangle that hid all of the light from the last x that one did: the first to try for the next.
  uint64_t cover_bvh = 0;
  uint32_t cover_block = 0;
  int cover_lane = 0, cover_which = 0;
};

/// Fills the list by the given path.
ShaftContent enter_shaft(const LineBvh& bvh, LinePath path, const ShaftQuery& query, Shaft::Parts& shaft,
                         QueryCounters& counters);
/// Visible parts of chords of a shaft that holds a list.
void visible_in_list(const LineBvh& bvh, LinePath path, const ShaftList& list,
                     std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                     QueryCounters& counters);

// The paths.
ShaftContent walk_shaft_avx2(const LineBvh& bvh, const Excluded& excluded, Shaft::Parts& shaft,
                             QueryCounters& counters);
ShaftContent walk_shaft_avx512(const LineBvh& bvh, const Excluded& excluded, Shaft::Parts& shaft,
                               QueryCounters& counters);
void visible_in_list_avx2(const LineBvh& bvh, const ShaftList& list, std::span<const LineQuery> queries,
                          std::vector<IntervalSet>& out, QueryCounters& counters);
void visible_in_list_avx512(const LineBvh& bvh, const ShaftList& list, std::span<const LineQuery> queries,
                            std::vector<IntervalSet>& out, QueryCounters& counters);

}  // namespace penumbra

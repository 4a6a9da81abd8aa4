#pragma once
// What a shaft keeps: its planes, and the triangles that can hide something of the light.
#include "worker/geometry/aligned.h"
#include "worker/geometry/line_bvh.h"
#include "worker/geometry/line_query.h"
#include "worker/geometry/shaft_planes.h"

namespace penumbra {

/// Triangles in the order found, packed into blocks.
class ShaftList {
 public:
  /// More than these and single line queries, which stop at what is hidden already, are the cheaper way
  /// (README: measured).
  static constexpr int kMost = 32;

  void clear() { count_ = 0; }
  int size() const { return count_; }
  /// Not beyond kMost.
  void add(const TriangleBlock& block, int lane) {
    TriangleBlock& to = blocks_[count_ / kWidth];
    const int at = count_++ % kWidth;
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) to.p[c][k][at] = block.p[c][k][lane];
    to.id[at] = block.id[lane];
  }
  /// Unused lanes of the last block become points, which no plane cuts.
  void finish();
  std::span<const TriangleBlock> blocks() const {
    return {blocks_, static_cast<size_t>((count_ + kWidth - 1) / kWidth)};
  }

 private:
  int count_ = 0;
  TriangleBlock blocks_[kMost / kWidth];
};

struct Shaft::Parts {
  ShaftPlanes planes;
  ShaftList list;
  /// A triangle that hid all of the light from the last x that one did: the first to try for the next.
  uint64_t cover_bvh = 0;
  uint32_t cover_block = 0;
  int cover_lane = 0;
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

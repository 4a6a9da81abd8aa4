#pragma once
// Buffers of one thread's line queries. They grow outside the vector code, which therefore instantiates no
// library template for an instruction set that other files may not use.
#include <cstdint>

#include "worker/geometry/aligned.h"
#include "worker/geometry/line_bvh.h"

namespace penumbra {

/// Memory of one line on its way.
struct LineBuffers {
  AlignedVector<uint32_t> stack, leaves;  ///< nodes still to visit; leaves found and not yet tested
  AlignedVector<float> lo, hi;            ///< visible intervals in no order; see VisibleSet

  void grow_set();
};

/// What one thread keeps between queries: memory, and a guess that changes no answer.
struct LineWorkspace {
  static constexpr int kTogether = 4;  ///< lines that are on their way at once
  LineBuffers lines[kTogether];
  /// The block of the last query that hid most of its chord: the first to try for the next one.
  uint64_t occluder_tree = 0;
  uint32_t occluder = 0;
};

/// This thread's workspace, with room for trees of the given depth.
LineWorkspace& line_workspace(uint32_t depth);

}  // namespace penumbra

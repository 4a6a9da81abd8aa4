#pragma once
// rtcBuildBVH behind a small door: boxes in, a wide tree out.
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "worker/geometry/line_bvh.h"

namespace penumbra {

/// One tree node while it is built. Leaves hold indices of the given boxes.
struct BuiltNode {
  uint32_t count = 0;
  bool leaf = false;
};
struct BuiltLeaf : BuiltNode {
  uint32_t items[kWidth];
};
struct BuiltInner : BuiltNode {
  BuiltNode* children[kWidth];
  Box bounds[kWidth];
};

class TreeBuilder {
 public:
  explicit TreeBuilder(int threads);
  ~TreeBuilder();
  /// Leaves of at most `leaf_size` (<= 16) boxes; a range of that size or less is not split further.
  /// Calls `use` with the root, which lives only during the call. `boxes` must not be empty.
  /// ResourceExhausted if Embree runs out of memory.
  absl::Status build(std::span<const Box> boxes, int leaf_size,
                     const std::function<void(const BuiltNode&)>& use);

 private:
  struct Device;
  int threads_;
  std::unique_ptr<Device> device_;  ///< made for the first tree of more than one leaf: it takes milliseconds
};

}  // namespace penumbra

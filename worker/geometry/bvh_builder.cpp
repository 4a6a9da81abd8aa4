#include "worker/geometry/bvh_builder.h"

#include <new>
#include <string>

#include "proto/status.h"
#include "worker/geometry/embree.h"

namespace penumbra {
namespace {

void* create_inner(RTCThreadLocalAllocator allocator, unsigned children, void*) {
  auto* node = new (rtcThreadLocalAlloc(allocator, sizeof(BuiltInner), alignof(BuiltInner))) BuiltInner;
  node->count = children;
  return static_cast<BuiltNode*>(node);
}

void set_children(void* node, void** children, unsigned count, void*) {
  auto* inner = static_cast<BuiltInner*>(static_cast<BuiltNode*>(node));
  for (unsigned i = 0; i < count; ++i) inner->children[i] = static_cast<BuiltNode*>(children[i]);
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
  auto* inner = static_cast<BuiltInner*>(static_cast<BuiltNode*>(node));
  for (unsigned i = 0; i < count; ++i) {
    inner->bounds[i] = {{bounds[i]->lower_x, bounds[i]->lower_y, bounds[i]->lower_z},
                        {bounds[i]->upper_x, bounds[i]->upper_y, bounds[i]->upper_z}};
  }
}

void* create_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* items, size_t count, void*) {
  PENUMBRA_CHECK(count <= kWidth);
  auto* leaf = new (rtcThreadLocalAlloc(allocator, sizeof(BuiltLeaf), alignof(BuiltLeaf))) BuiltLeaf;
  leaf->leaf = true;
  leaf->count = static_cast<uint32_t>(count);
  for (size_t i = 0; i < count; ++i) leaf->items[i] = items[i].primID;
  return static_cast<BuiltNode*>(leaf);
}

std::vector<RTCBuildPrimitive> primitives_of(std::span<const Box> boxes) {
  std::vector<RTCBuildPrimitive> primitives(boxes.size());
  for (size_t i = 0; i < boxes.size(); ++i) {
    const Box& b = boxes[i];
    primitives[i] = {b.lo.x, b.lo.y, b.lo.z, 0, b.hi.x, b.hi.y, b.hi.z, static_cast<uint32_t>(i)};
  }
  return primitives;
}

/// All there is, unsplit.
BuiltLeaf only_leaf(size_t count) {
  BuiltLeaf leaf;
  leaf.leaf = true;
  leaf.count = static_cast<uint32_t>(count);
  for (uint32_t i = 0; i < leaf.count; ++i) leaf.items[i] = i;
  return leaf;
}

}  // namespace

struct TreeBuilder::Device {
  DeviceHandle handle;
  explicit Device(int threads) : handle(make_device(threads)) { PENUMBRA_CHECK(handle != nullptr); }
};

TreeBuilder::TreeBuilder(int threads) : threads_(threads) {}

TreeBuilder::~TreeBuilder() = default;

absl::Status TreeBuilder::build(std::span<const Box> boxes, int leaf_size,
                                const std::function<void(const BuiltNode&)>& use) {
  if (boxes.size() <= static_cast<size_t>(leaf_size)) {
    use(only_leaf(boxes.size()));
    return absl::OkStatus();
  }
  if (!device_) device_ = std::make_unique<Device>(threads_);
  const BvhHandle bvh(rtcNewBVH(device_->handle.get()));
  std::vector<RTCBuildPrimitive> primitives = primitives_of(boxes);

  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = kWidth;
  arguments.maxDepth = 64;
  arguments.sahBlockSize = static_cast<unsigned>(leaf_size);
  arguments.minLeafSize = static_cast<unsigned>(leaf_size);
  arguments.maxLeafSize = static_cast<unsigned>(leaf_size);
  arguments.bvh = bvh.get();
  arguments.primitives = primitives.data();
  arguments.primitiveCount = primitives.size();
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_inner;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  const void* root = rtcBuildBVH(&arguments);
  if (root == nullptr) {
    return make_status(absl::StatusCode::kResourceExhausted, "line hierarchy over {} boxes: Embree error {}",
                       boxes.size(), static_cast<int>(rtcGetDeviceError(device_->handle.get())));
  }
  use(*static_cast<const BuiltNode*>(root));
  return absl::OkStatus();
}

}  // namespace penumbra

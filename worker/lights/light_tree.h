#pragma once
// A binary tree over lights by their bounds, from which one is drawn in proportion to what it is estimated to
// contribute at a point, in O(log n). Conty Estévez & Kulla 2018.
#include <cstdint>
#include <span>
#include <vector>

#include "worker/lights/light_bounds.h"

namespace penumbra {

/// A light that was drawn. probability 0: none.
struct DrawnLight {
  size_t light = 0;
  double probability = 0;
};

class LightTree {
 public:
  LightTree() = default;
  explicit LightTree(std::span<const LightBounds> lights);

  /// Importance of all lights together at the receiver; 0: none can reach it.
  double importance(const Receiver& receiver) const;
  /// The light at quantile u in [0,1).
  DrawnLight draw(const Receiver& receiver, double u) const;
  /// Probability with which draw() returns a light.
  double probability(const Receiver& receiver, size_t light) const;

 private:
  static constexpr uint32_t kNoNode = ~uint32_t{0};
  struct Node {
    LightBounds bounds;
    uint32_t parent = kNoNode;
    /// The second child; the first one follows its parent. kNoNode: a leaf.
    uint32_t second = kNoNode;
    uint32_t light = 0;  ///< of a leaf
  };
  uint32_t build(std::span<const LightBounds> lights, std::span<uint32_t> order, uint32_t parent);
  /// Probability of the first child of an inner node, given that one is reached; negative: of neither.
  double share_of_first(uint32_t node, const Receiver& receiver) const;

  std::vector<Node> nodes_;       ///< parents before children
  std::vector<uint32_t> leaves_;  ///< per light: its node
};

}  // namespace penumbra

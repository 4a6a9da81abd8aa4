#pragma once
// From the densities at a point to what the sample there counts: the combinations of the mix grammar,
// design §6. The weights themselves are sampling/mis.h.
#include <span>
#include <vector>

#include "proto/mix.h"

namespace penumbra {

/// What is known of one point of a light, or one direction: which strategy found it, and how likely it was
/// for every strategy of the mix.
struct Found {
  size_t slot = 0;  ///< of the strategy that found it
  double pdf = 0;   ///< of that strategy: > 0
  /// `/free` weighs as if nothing were hidden: this is by how much smaller that strategy's density is then.
  double visible = 1;
  double smoothing =
      1;  ///< s of smoothing.h at this point: of the densities of strategies that are not lines
  std::span<const double>
      densities;  ///< one per slot, as the combination weighs; the own one is pdf × visible
};

/// Keeps scratch memory; belongs to one thread.
class Combiner {
 public:
  /// Per slot: expected samples (0: the strategy has no say); whether its strategy is a line.
  void start(Combination how, std::span<const double> counts, const std::vector<bool>& lines);

  /// Weight of the strategy that found the point, among all that could have: Σ over the slots is 1.
  double weight(const Found& found);
  /// weight / (n p): what f is multiplied by.
  double scale(const Found& found);

 private:
  Combination how_ = Combination::kBalance;
  std::vector<double> counts_, smoothing_, weights_;
  std::vector<bool> lines_;
};

}  // namespace penumbra

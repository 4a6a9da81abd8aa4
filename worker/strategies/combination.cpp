#include "worker/strategies/combination.h"

#include "proto/status.h"
#include "worker/sampling/mis.h"

namespace penumbra {

void Combiner::start(Combination how, std::span<const double> counts, const std::vector<bool>& lines) {
  PENUMBRA_CHECK(counts.size() == lines.size());
  how_ = how;
  counts_.assign(counts.begin(), counts.end());
  lines_ = lines;
  smoothing_.resize(counts.size());
  weights_.resize(counts.size());
}

double Combiner::weight(const Found& found) {
  switch (how_) {
    case Combination::kAverage:
      return 1 / double(counts_.size());
    case Combination::kPower:
      power_weights(counts_, found.densities, weights_);
      break;
    case Combination::kBalance:
    case Combination::kFree:
      balance_weights(counts_, found.densities, {}, weights_);
      break;
    case Combination::kSmooth:
      for (size_t s = 0; s < lines_.size(); ++s) smoothing_[s] = lines_[s] ? 1 : found.smoothing;
      balance_weights(counts_, found.densities, smoothing_, weights_);
      break;
  }
  return weights_[found.slot];
}

double Combiner::scale(const Found& found) {
  const bool balances = how_ == Combination::kBalance || how_ == Combination::kFree;
  // n p stands in the weight's numerator, too, but for what `/free` leaves out of it.
  if (balances) return found.visible * inverse_sum(counts_, found.densities);
  return weight(found) / (counts_[found.slot] * found.pdf);
}

}  // namespace penumbra

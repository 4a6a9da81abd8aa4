#include "proto/blocks.h"

#include <algorithm>

namespace penumbra {

double mean_share(const PixelRect& tile, const std::vector<uint8_t>& shares) {
  if (shares.empty()) return 1;
  double sum = 0;
  for (size_t b = 0; b < shares.size(); ++b)
    sum += static_cast<double>(shares[b]) * static_cast<double>(block_rect(tile, b).area());
  return sum / (kWholeShare * static_cast<double>(tile.area()));
}

double block_passes_sum(const PixelRect& tile, const std::vector<uint8_t>& shares, int64_t group,
                        int64_t passes) {
  if (shares.empty()) return static_cast<double>(passes) * static_cast<double>(tile.area());
  double sum = 0;
  for (size_t b = 0; b < shares.size(); ++b)
    sum += static_cast<double>(passes_of_block(passes, shares[b], group)) *
           static_cast<double>(block_rect(tile, b).area());
  return sum;
}

bool shares_fit(const PixelRect& tile, const std::vector<uint8_t>& shares) {
  return shares.empty() || (shares.size() == block_count(tile) &&
                            std::none_of(shares.begin(), shares.end(), [](uint8_t s) { return s == 0; }));
}

}  // namespace penumbra

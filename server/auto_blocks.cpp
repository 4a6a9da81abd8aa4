#include "server/auto_blocks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "proto/blocks.h"
#include "proto/status.h"

namespace penumbra {
namespace {

// A block's own measurement counts as much as those of so many neighbours: it is some hundred samples, of
// which few may hold most of the variance.
constexpr double kOwnWeight = 4;
// What every block is presumed to have of the tile's mean, whatever the pilot has (not) seen there.
constexpr double kCommonPart = 0.2;
// Shares that save less than this are not worth the groups that they cut smaller.
constexpr double kLeastGain = 0.05;

/// Figures per pixel, drawn a little towards those of the blocks beside and the tile's mean.
std::vector<double> smoothed_density(const PixelRect& tile, const std::vector<double>& figures) {
  const int columns = block_columns(tile);
  const auto count = static_cast<int>(figures.size());
  std::vector<double> density, out;
  for (size_t b = 0; b < figures.size(); ++b)
    density.push_back(figures[b] / static_cast<double>(block_rect(tile, b).area()));
  const double mean = std::accumulate(figures.begin(), figures.end(), 0.0) / static_cast<double>(tile.area());
  for (int b = 0; b < count; ++b) {
    double sum = kOwnWeight * density[static_cast<size_t>(b)], weight = kOwnWeight;
    const auto add = [&](bool inside, int other) {
      if (!inside) return;
      sum += density[static_cast<size_t>(other)];
      ++weight;
    };
    add(b % columns > 0, b - 1);
    add(b % columns < columns - 1, b + 1);
    add(b >= columns, b - columns);
    add(b + columns < count, b + columns);
    out.push_back((1 - kCommonPart) * sum / weight + kCommonPart * mean);
  }
  return out;
}

/// Of each block: its pixels times the square of their mean deviation.
std::vector<double> squares(const PixelRect& tile, const std::vector<BlockCost>& blocks) {
  std::vector<double> out;
  for (const BlockCost& block : blocks) {
    const auto area = static_cast<double>(block_rect(tile, out.size()).area());
    const double deviation = static_cast<double>(block.relative_deviation) / area;
    out.push_back(area * deviation * deviation);
  }
  return out;
}

}  // namespace

double squared_deviations(const PixelRect& tile, const std::vector<BlockCost>& blocks) {
  if (blocks.size() != block_count(tile)) return 0;
  const std::vector<double> all = squares(tile, blocks);
  return std::accumulate(all.begin(), all.end(), 0.0);
}

SharedOut shared_out(const PixelRect& tile, const std::vector<BlockCost>& blocks, double least) {
  PENUMBRA_CHECK(kLeastBlockShare <= least && least <= 1);
  if (blocks.size() != block_count(tile)) return {};
  const std::vector<double> variances = squares(tile, blocks);
  std::vector<double> costs;
  for (const BlockCost& block : blocks) costs.push_back(static_cast<double>(block.cpu_seconds));
  const std::vector<double> variance = smoothed_density(tile, variances),
                            cost = smoothed_density(tile, costs);
  std::vector<double> weights;
  for (size_t b = 0; b < blocks.size(); ++b) weights.push_back(std::sqrt(variance[b] / cost[b]));
  const double largest = *std::max_element(weights.begin(), weights.end());
  if (!(largest > 0) || !std::isfinite(largest)) return {};  // nothing varies, or nothing took time

  SharedOut out;
  double left = 0, left_alike = 0, spent = 0, spent_alike = 0;
  for (size_t b = 0; b < blocks.size(); ++b) {
    const auto area = static_cast<double>(block_rect(tile, b).area());
    const double share = std::ceil(kWholeShare * std::max(weights[b] / largest, least));
    out.shares.push_back(static_cast<uint8_t>(share));
    left += area * variance[b] * kWholeShare / share;
    left_alike += area * variance[b];
    spent += area * cost[b] * share / kWholeShare;
    spent_alike += area * cost[b];
  }
  out.error = left / left_alike;
  out.cost = spent / spent_alike;
  return out.error * out.cost < 1 - kLeastGain ? out : SharedOut{};
}

}  // namespace penumbra

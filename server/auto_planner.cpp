#include "server/auto_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "proto/status.h"
#include "server/auto_blocks.h"
#include "server/auto_measurements.h"

namespace penumbra {
namespace {

// Pixels of a pilot's block (worker/render/candidate_pilot.cpp) and passes in each.
constexpr double kBlockPixels = 4 * 2, kBlockSamples = kBlockPixels * 4;
// Pixels beyond this share of a tile would tell little more than their neighbours did.
constexpr double kMostBlockShare = 0.25;
// A pilot of counted work may take this share of the run's passes.
constexpr double kPilotShare = 0.08;
// What a tile's own measurement is weighed against, in pixels: those of each neighbour and of the whole
// image, for how much varies here (level) and for how candidates compare (ratio). Levels change from tile to
// tile.
constexpr double kNeighbourLevelPixels = 1, kImageLevelPixels = 1;
constexpr double kNeighbourRatioPixels = 4, kImageRatioPixels = 16;
// A mix without `bsdf` has no bound on f / p where a lobe is narrow, and a pilot that has not met the lobe
// cannot know: the image's part of its ratio counts as so much worse until the tile's own pixels outweigh it.
constexpr double kUnboundedRatio = 3;
constexpr double kMostRatio = 256;
// No tile gets fewer than this share of the mean passes, whatever the pilot has (not) seen there.
constexpr double kLeastShare = 0.4;
constexpr double kMostPasses = 1e12;  // far beyond any run; keeps conversions defined

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Tiles around tile t, which differ from it in column and row by one at most.
std::vector<size_t> neighbours(size_t t, size_t columns, size_t tiles) {
  std::vector<size_t> out;
  const auto x = static_cast<ptrdiff_t>(t % columns), y = static_cast<ptrdiff_t>(t / columns);
  for (ptrdiff_t j = y - 1; j <= y + 1; ++j)
    for (ptrdiff_t i = x - 1; i <= x + 1; ++i) {
      const ptrdiff_t other = j * static_cast<ptrdiff_t>(columns) + i;
      const bool inside = i >= 0 && i < static_cast<ptrdiff_t>(columns) && j >= 0;
      if (inside && other < static_cast<ptrdiff_t>(tiles) && other != static_cast<ptrdiff_t>(t))
        out.push_back(static_cast<size_t>(other));
    }
  return out;
}

/// Weighted mean of a tile's own figure (weight: the pixels it is worth), its neighbours' and the image's.
/// Figures are in units of what is typical of the image.
struct Blend {
  double neighbour_pixels, image_pixels, image_figure;
};
double blended(const std::vector<double>& figures, const std::vector<double>& pixels, const Blend& blend,
               size_t t, size_t columns) {
  double sum = pixels[t] * figures[t] + blend.image_pixels * blend.image_figure;
  double weight = pixels[t] + blend.image_pixels;
  for (const size_t other : neighbours(t, columns, figures.size())) {
    const double w = std::min(blend.neighbour_pixels, pixels[other]);
    sum += w * figures[other];
    weight += w;
  }
  return sum / weight;
}

/// What the image says of each candidate: the arithmetic mean, which holds the rare bright samples that the
/// few pixels of a tile have missed. A candidate that is wild somewhere needs strong evidence elsewhere.
std::vector<double> typical(const Table& figures, const std::vector<double>& areas) {
  std::vector<double> sums(figures[0].size(), 0);
  const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
  for (size_t t = 0; t < figures.size(); ++t)
    for (size_t k = 0; k < sums.size(); ++k) sums[k] += areas[t] * figures[t][k] / area;
  return sums;
}

/// How a tile compares with the image: the median over the candidates of figure_tk / typical_k, their mean
/// where most of them found nothing.
double level_of(const std::vector<double>& figures, const std::vector<double>& typical) {
  std::vector<double> relative;
  for (size_t k = 0; k < figures.size(); ++k)
    if (typical[k] > 0) relative.push_back(figures[k] / typical[k]);
  if (relative.empty()) return 0;
  const double mean =
      std::accumulate(relative.begin(), relative.end(), 0.0) / static_cast<double>(relative.size());
  const double middle = median(std::move(relative));
  return middle > 0 ? middle : mean;
}

std::vector<double> column(const Table& table, size_t k) {
  std::vector<double> out;
  for (const std::vector<double>& row : table) out.push_back(row[k]);
  return out;
}

constexpr Blend kLevelBlend{kNeighbourLevelPixels, kImageLevelPixels, 1};

/// Figures by which candidates are compared, drawn towards those around and the image's, where a tile's few
/// pixels leave room for these: figure_tk = level_t × ratio_tk × typical_k; levels and ratios are blended,
/// each by itself. `image_ratios`: what the image's part of a candidate's ratio counts as.
Table comparable(const Table& figures, const Table& pixels, const std::vector<double>& image,
                 const std::vector<double>& image_ratios, size_t columns) {
  Table out = figures;
  std::vector<double> levels, worth;
  for (size_t t = 0; t < figures.size(); ++t) {
    levels.push_back(level_of(figures[t], image));
    worth.push_back(median(pixels[t]));
  }
  for (size_t k = 0; k < image.size(); ++k) {
    // Where next to nothing varies a ratio may be anything: beyond these bounds it says «far better» or «far
    // worse», and not by how much.
    std::vector<double> ratios;
    for (size_t t = 0; t < figures.size(); ++t)
      ratios.push_back(levels[t] > 0 && image[k] > 0
                           ? std::clamp(figures[t][k] / (levels[t] * image[k]), 1 / kMostRatio, kMostRatio)
                           : 1);
    const std::vector<double> weights = column(pixels, k);
    const Blend ratio_blend{kNeighbourRatioPixels, kImageRatioPixels, image_ratios[k]};
    for (size_t t = 0; t < figures.size(); ++t)
      out[t][k] = blended(levels, worth, kLevelBlend, t, columns) * image[k] *
                  blended(ratios, weights, ratio_blend, t, columns);
  }
  return out;
}

/// Figures by which passes are given out: each candidate's own, drawn a little towards those around.
Table smoothed(const Table& figures, const Table& pixels, const std::vector<double>& image, size_t columns) {
  Table out = figures;
  for (size_t k = 0; k < image.size(); ++k) {
    if (!(image[k] > 0)) continue;
    std::vector<double> relative = column(figures, k);
    for (double& figure : relative) figure /= image[k];
    const std::vector<double> weights = column(pixels, k);
    for (size_t t = 0; t < figures.size(); ++t)
      out[t][k] = image[k] * blended(relative, weights, kLevelBlend, t, columns);
  }
  return out;
}

/// One tile's best candidate, and what a pass of it costs and leaves: of the whole tile, with its blocks'
/// shares.
struct Choice {
  int candidate;
  double variance, cost;
  std::vector<uint8_t> shares;
  /// Passes are in proportion to this; 0 where nothing varies.
  double weight() const { return std::sqrt(variance / cost); }
};

std::vector<double> image_ratios(const std::vector<int>& candidates) {
  std::vector<double> out;
  for (const int k : candidates)
    out.push_back(is_bounded(auto_candidates()[static_cast<size_t>(k)]) ? 1 : kUnboundedRatio);
  return out;
}

/// How much varies in each tile, from two views of it: what the candidates found in few pixels (`few`, per
/// tile), and the deviations of whole passes, where there were any. Both are noisy, in ways of their own:
/// their geometric mean, in the first one's units.
std::vector<double> tile_variances(const std::vector<PixelRect>& tiles, const Measurements& m,
                                   std::vector<double> few) {
  std::vector<double> whole;
  double sum_few = 0;
  for (size_t t = 0; t < tiles.size(); ++t) {
    whole.push_back(squared_deviations(tiles[t], m.blocks[t]));
    if (!(whole[t] > 0)) continue;
    sum_few += few[t];
  }
  if (!(sum_few > 0)) return few;
  double sum = 0;
  for (size_t t = 0; t < tiles.size(); ++t) {
    if (!(whole[t] > 0)) continue;
    few[t] = std::sqrt(few[t] * whole[t]);
    sum += few[t];
  }
  // Geometric means are smaller on the whole; the sum stays what it was.
  for (size_t t = 0; t < tiles.size(); ++t)
    if (whole[t] > 0 && sum > 0) few[t] *= sum_few / sum;
  return few;
}

std::vector<Choice> choices(const std::vector<PixelRect>& tiles, const Measurements& m) {
  std::vector<double> areas;
  for (const PixelRect& tile : tiles) areas.push_back(static_cast<double>(tile.area()));
  const auto columns = static_cast<size_t>(std::count_if(
      tiles.begin(), tiles.end(), [&](const PixelRect& tile) { return tile.y0 == tiles[0].y0; }));
  const std::vector<double> image = typical(m.variance, areas), image_cost = typical(m.cost, areas);
  const Table compared = comparable(m.variance, m.worth, image, image_ratios(m.candidates), columns);
  const Table variance = smoothed(m.variance, m.worth, image, columns);
  const Table cost = smoothed(m.cost, m.measured, image_cost, columns);
  std::vector<size_t> chosen;
  std::vector<double> found;
  for (size_t t = 0; t < areas.size(); ++t) {
    size_t best = 0;
    for (size_t k = 1; k < m.candidates.size(); ++k) {
      const double a = compared[t][k] * cost[t][k], b = compared[t][best] * cost[t][best];
      if (a < b || (a == b && cost[t][k] < cost[t][best])) best = k;
    }
    chosen.push_back(best);
    found.push_back(areas[t] * variance[t][best]);
  }
  found = tile_variances(tiles, m, std::move(found));
  std::vector<Choice> out;
  for (size_t t = 0; t < areas.size(); ++t) {
    const double whole_cost = areas[t] * cost[t][chosen[t]];
    SharedOut shared = shared_out(tiles[t], m.blocks[t]);
    out.push_back({m.candidates[chosen[t]], found[t] * shared.error, whole_cost * shared.cost,
                   std::move(shared.shares)});
  }
  return out;
}

/// Passes λ w_t, but nowhere less than kLeastShare of their mean nor than `least`.
std::vector<double> allocated(const std::vector<Choice>& tiles, double lambda, double least) {
  std::vector<double> passes;
  double sum = 0;
  for (const Choice& tile : tiles) {
    passes.push_back(lambda * tile.weight());
    sum += passes.back();
  }
  const double floor = std::max(least, kLeastShare * sum / static_cast<double>(tiles.size()));
  for (double& n : passes) n = std::clamp(n, floor, kMostPasses);
  return passes;
}

double cost_of(const std::vector<Choice>& tiles, const std::vector<double>& passes) {
  double sum = 0;
  for (size_t t = 0; t < tiles.size(); ++t) sum += tiles[t].cost * passes[t];
  return sum;
}

double error_of(const std::vector<Choice>& tiles, const std::vector<double>& passes) {
  double sum = 0;
  for (size_t t = 0; t < tiles.size(); ++t) sum += tiles[t].variance / passes[t];
  return sum;
}

/// The λ at which enough(passes) becomes true; by bisection in its logarithm, to rounding.
template <class Enough>
std::vector<double> solve(const std::vector<Choice>& tiles, double least, Enough enough) {
  double low = -60, high = 60;  // of log2 λ relative to one pass per mean weight
  double mean_weight = 0;
  for (const Choice& tile : tiles) mean_weight += tile.weight() / static_cast<double>(tiles.size());
  if (!(mean_weight > 0)) return allocated(tiles, 0, least);
  for (int i = 0; i < 80; ++i) {
    const double middle = (low + high) / 2;
    (enough(allocated(tiles, std::exp2(middle) / mean_weight, least)) ? high : low) = middle;
  }
  return allocated(tiles, std::exp2(high) / mean_weight, least);
}

/// Whole passes, up or down such that the cost so far stays nearest to what the fractions would have cost.
std::vector<int64_t> rounded(const std::vector<Choice>& tiles, const std::vector<double>& passes) {
  std::vector<int64_t> out;
  double owed = 0;
  for (size_t t = 0; t < tiles.size(); ++t) {
    const double down = std::floor(passes[t]), part = passes[t] - down;
    owed += part * tiles[t].cost;
    const bool up = owed >= tiles[t].cost / 2 && part > 0;
    if (up) owed -= tiles[t].cost;
    out.push_back(static_cast<int64_t>(down) + (up ? 1 : 0));
  }
  return out;
}

/// Passes that spend `seconds` of the pilot's time, where some are rendered already.
std::vector<int64_t> spending_passes(const std::vector<Choice>& tiles, double seconds,
                                     const std::vector<int64_t>& least) {
  const auto raised = [&](std::vector<double> passes) {
    for (size_t t = 0; t < least.size(); ++t) passes[t] = std::max(passes[t], static_cast<double>(least[t]));
    return passes;
  };
  return rounded(tiles, raised(solve(tiles, 1, [&](const std::vector<double>& passes) {
                   return cost_of(tiles, raised(passes)) >= seconds;
                 })));
}

std::vector<int64_t> passes_of(const JobSpec& spec, const std::vector<Choice>& tiles, double pilot_seconds,
                               const AutoSpending& spending) {
  if (const auto* spp = std::get_if<SppBudget>(&spec.budget))
    return std::vector<int64_t>(tiles.size(), spp->passes);
  if (const auto* cpu = std::get_if<CpuSecondsBudget>(&spec.budget))
    return spending_passes(tiles, (cpu->seconds - pilot_seconds - spending.repilot_seconds) / spending.factor,
                           spending.least);
  const double wanted =
      std::get<TargetErrorBudget>(spec.budget).relmse * 3 * static_cast<double>(spec.crop.area());
  std::vector<int64_t> out;
  for (const double n :
       solve(tiles, 2, [&](const std::vector<double>& passes) { return error_of(tiles, passes) <= wanted; }))
    out.push_back(static_cast<int64_t>(std::ceil(n)));
  return out;
}

}  // namespace

int pilot_blocks(const JobSpec& spec, const PixelRect& tile) {
  const double area = static_cast<double>(tile.area());
  double most = kMostBlockShare * area / kBlockPixels;
  if (const auto* spp = std::get_if<SppBudget>(&spec.budget))
    most = std::min(most, kPilotShare * static_cast<double>(spp->passes) * area /
                              (kBlockSamples * static_cast<double>(common_candidates())));
  return static_cast<int>(std::max(1.0, std::round(most)));
}

absl::StatusOr<AutoPlan> plan_auto(const JobSpec& spec, const std::vector<PixelRect>& tiles,
                                   const std::vector<std::vector<MixCost>>& pilot, size_t number,
                                   const AutoSpending& spending) {
  ASSIGN_OR_RETURN(const Measurements m, measurements(spec, tiles, pilot, number));
  const std::vector<Choice> chosen = choices(tiles, m);
  const std::vector<int64_t> passes = passes_of(spec, chosen, m.pilot_seconds, spending);
  AutoPlan plan{automatic_mixes(spec.mixes)[number], auto_candidates(), {}};
  const bool counted = std::holds_alternative<SppBudget>(spec.budget);  // so many in every pixel
  for (size_t t = 0; t < tiles.size(); ++t)
    plan.tiles.push_back(
        {chosen[t].candidate, passes[t], counted ? std::vector<uint8_t>{} : chosen[t].shares});
  return plan;
}

absl::StatusOr<std::vector<double>> auto_pass_costs(const JobSpec& spec, const std::vector<PixelRect>& tiles,
                                                    const std::vector<std::vector<MixCost>>& pilot,
                                                    size_t number) {
  ASSIGN_OR_RETURN(const Measurements m, measurements(spec, tiles, pilot, number));
  std::vector<double> costs;
  for (const Choice& choice : choices(tiles, m)) costs.push_back(choice.cost);
  return costs;
}

}  // namespace penumbra

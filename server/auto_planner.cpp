#include "server/auto_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "proto/blocks.h"
#include "proto/status.h"
#include "server/auto_blocks.h"
#include "server/auto_compare.h"
#include "server/auto_measurements.h"

namespace penumbra {
namespace {

// Pixels of a pilot's block (worker/render/candidate_pilot.cpp) and passes in each.
constexpr double kBlockPixels = 4 * 2, kBlockSamples = kBlockPixels * 4;
// Pixels beyond this share of a tile would tell little more than their neighbours did.
constexpr double kMostBlockShare = 0.25;
// A pilot of counted work may take this share of the run's passes; a little more where a scene's media make
// it try more candidates than others have.
constexpr double kPilotShare = 0.08;
// A mix without `bsdf` has no bound on f / p where a lobe is narrow (worker/materials/scattering.h). A tile
// with such a lobe, or beside one, takes no such mix, whatever its few pixels say: in the kitchen a shiny
// table went to `sa:4` by its pilot, and a dozen of its pixels were then a tenth of the image's error.
// Elsewhere the pilot may not have met the lobe: the image's part of the mix's ratio counts as so much worse
// until the tile's own pixels outweigh it.
constexpr double kUnboundedRatio = 3;
// No tile gets fewer than this share of the mean passes, whatever the pilot has (not) seen there.
constexpr double kLeastShare = 0.4;
// No pixel gets fewer passes than this, nor than kLeastPart of the mean where that is less: a pilot of four
// passes has not seen what happens in one of ten. The kitchen at 16 passes a pixel: blocks with three or four
// of them had its largest errors, and the plan was no better than one without blocks.
constexpr double kLeastPasses = 8, kLeastPart = 0.6;
constexpr double kMostPasses = 1e12;  // far beyond any run; keeps conversions defined

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

/// Per tile: may a mix without `bsdf` serve it?
std::vector<bool> takes_unbounded(const std::vector<bool>& lobed, size_t columns) {
  std::vector<bool> out;
  for (size_t t = 0; t < lobed.size(); ++t) {
    const std::vector<size_t> around = neighbours(t, columns, lobed.size());
    out.push_back(!lobed[t] &&
                  std::none_of(around.begin(), around.end(), [&](size_t other) { return lobed[other]; }));
  }
  return out;
}

/// The measured candidate (its place among them) of least variance × cost in a tile.
size_t best_of(const Measurements& m, const std::vector<double>& variance, const std::vector<double>& cost,
               bool unbounded) {
  const auto may_serve = [&](size_t k) {
    return unbounded || is_bounded(auto_candidates()[static_cast<size_t>(m.candidates[k])]);
  };
  std::optional<size_t> best;
  for (size_t k = 0; k < m.candidates.size(); ++k) {
    if (!may_serve(k)) continue;
    const double a = variance[k] * cost[k], b = best ? variance[*best] * cost[*best] : 0;
    if (!best || a < b || (a == b && cost[k] < cost[*best])) best = k;
  }
  // A pilot that has measured no bounded mix leaves no choice.
  return best ? *best : best_of(m, variance, cost, true);
}

/// Of each tile its best candidate; blocks all alike.
std::vector<Choice> whole_choices(const std::vector<PixelRect>& tiles, const Measurements& m) {
  std::vector<double> areas;
  for (const PixelRect& tile : tiles) areas.push_back(static_cast<double>(tile.area()));
  const auto columns = static_cast<size_t>(std::count_if(
      tiles.begin(), tiles.end(), [&](const PixelRect& tile) { return tile.y0 == tiles[0].y0; }));
  const std::vector<double> image = typical(m.variance, areas), image_cost = typical(m.cost, areas);
  const Table compared = comparable(m.variance, m.worth, image, image_ratios(m.candidates), columns);
  const Table variance = smoothed(m.variance, m.worth, image, columns);
  const Table cost = smoothed(m.cost, m.measured, image_cost, columns);
  const std::vector<bool> unbounded = takes_unbounded(m.lobed, columns);
  std::vector<size_t> chosen;
  std::vector<double> found;
  for (size_t t = 0; t < areas.size(); ++t) {
    const size_t best = best_of(m, compared[t], cost[t], unbounded[t]);
    chosen.push_back(best);
    found.push_back(areas[t] * variance[t][best]);
  }
  found = tile_variances(tiles, m, std::move(found));
  std::vector<Choice> out;
  for (size_t t = 0; t < areas.size(); ++t)
    out.push_back({m.candidates[chosen[t]], found[t], areas[t] * cost[t][chosen[t]], {}});
  return out;
}

/// With blocks' shares, none below the tile's `least`.
std::vector<Choice> with_blocks(const std::vector<PixelRect>& tiles, const Measurements& m,
                                std::vector<Choice> whole, const std::vector<double>& least) {
  for (size_t t = 0; t < tiles.size(); ++t) {
    SharedOut shared = shared_out(tiles[t], m.blocks[t], least[t]);
    whole[t].variance *= shared.error;
    whole[t].cost *= shared.cost;
    whole[t].shares = std::move(shared.shares);
  }
  return whole;
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

/// Mean over the picture's pixels.
double mean_passes(const std::vector<PixelRect>& tiles, const std::vector<Choice>& choices,
                   const std::vector<int64_t>& passes) {
  double sum = 0, area = 0;
  for (size_t t = 0; t < tiles.size(); ++t) {
    const auto pixels = static_cast<double>(tiles[t].area());
    sum += pixels * mean_share(tiles[t], choices[t].shares) * static_cast<double>(passes[t]);
    area += pixels;
  }
  return sum / area;
}

/// Sums and quotients of these stay numbers. What a worker reports is finite, but may be anything else.
absl::Status check_range(const std::vector<Choice>& choices) {
  constexpr double kMost = 1e60;
  for (const Choice& choice : choices)
    if (!(choice.variance >= 0 && choice.variance <= kMost && choice.cost >= 1 / kMost &&
          choice.cost <= kMost))
      return make_status(absl::StatusCode::kInternal,
                         "the pilot of `auto` has measured a variance of {} at a cost of {}", choice.variance,
                         choice.cost);
  return absl::OkStatus();
}

/// Candidates and shares follow from the pilot and the budget alone, so that they stay when totals are
/// planned anew. What a least number of passes means for shares depends on the tiles' passes, and these on
/// the shares: a few rounds settle it.
absl::StatusOr<std::vector<Choice>> choices(const JobSpec& spec, const std::vector<PixelRect>& tiles,
                                            const Measurements& m) {
  const std::vector<Choice> whole = whole_choices(tiles, m);
  std::vector<double> least(tiles.size(), kLeastBlockShare);
  std::vector<Choice> chosen = with_blocks(tiles, m, whole, least);
  RETURN_IF_ERROR(check_range(chosen));
  if (std::holds_alternative<SppBudget>(spec.budget)) return chosen;
  for (int round = 0; round < 3; ++round) {
    const std::vector<int64_t> passes = passes_of(spec, chosen, m.pilot_seconds, {});
    const double wanted = std::min(kLeastPasses, kLeastPart * mean_passes(tiles, chosen, passes));
    for (size_t t = 0; t < tiles.size(); ++t)
      least[t] = std::clamp(wanted / static_cast<double>(passes[t]), kLeastBlockShare, 1.0);
    chosen = with_blocks(tiles, m, whole, least);
    RETURN_IF_ERROR(check_range(chosen));
  }
  return chosen;
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
  ASSIGN_OR_RETURN(const std::vector<Choice> chosen, choices(spec, tiles, m));
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
  ASSIGN_OR_RETURN(const std::vector<Choice> chosen, choices(spec, tiles, m));
  for (const Choice& choice : chosen) costs.push_back(choice.cost);
  return costs;
}

}  // namespace penumbra

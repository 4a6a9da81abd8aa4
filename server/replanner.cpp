#include "server/replanner.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "proto/auto_plan.h"
#include "proto/blocks.h"
#include "proto/status.h"
#include "server/auto_planner.h"

namespace penumbra {
namespace {

// What is repeated: as many passes of tiles per mix, within these shares of the passes that are kept.
constexpr double kRepilotPasses = 60;
constexpr double kLeastRepilotShare = 0.02, kMostRepilotShare = 0.05;
// The pilot's ratio between mixes is about as sure as that of so many repeated passes.
constexpr double kRatioPasses = 30;
// Nothing is decided any more after the border before the last.
constexpr double kRepilotUntil = kStageBorders[std::size(kStageBorders) - 2];

/// Which of the passes are followed by one that is repeated: every so many of them, tiles and mixes one
/// after the other (multiples of the golden ratio).
double phase(uint64_t number) {
  const double at = static_cast<double>(number) * 0.6180339887498949;
  return at - std::floor(at);
}

double repilot_share(const PlannedPasses& planned, size_t tiles, size_t mix) {
  // Of what was planned first: what is sure may not change with later plans.
  const int64_t passes = stages_of(planned, mix).front().total;
  return std::clamp(
      kRepilotPasses / (kRepilotUntil * static_cast<double>(passes) * static_cast<double>(tiles)),
      kLeastRepilotShare, kMostRepilotShare);
}

/// Seconds that the pilot foretells for a pass: per mix, per tile.
absl::StatusOr<std::vector<std::vector<double>>> pass_seconds(
    const JobSpec& spec, const std::vector<PixelRect>& tiles,
    const std::vector<std::vector<MixCost>>& pilot) {
  std::vector<std::vector<double>> seconds;
  size_t automatic = 0;
  for (size_t m = 0; m < spec.mixes.size(); ++m) {
    seconds.emplace_back();
    if (spec.mixes[m].automatic) {
      ASSIGN_OR_RETURN(seconds.back(), auto_pass_costs(spec, tiles, pilot, automatic++));
      continue;
    }
    for (const std::vector<MixCost>& tile : pilot) {
      if (tile.size() <= m || tile[m].passes < 1)
        return make_status(absl::StatusCode::kInternal, "a pilot task of mix {} has rendered no pass", m);
      seconds.back().push_back(tile[m].cpu_seconds / static_cast<double>(tile[m].passes));
    }
  }
  return seconds;
}

/// Of one mix: what is known of its repeated passes, and what those that are still to come will take.
struct Repeated {
  Speed speed;
  double to_come = 0;  ///< in the pilot's seconds
};

std::vector<Repeated> repeated(const JobSpec& spec, const Plan& plan, size_t tiles,
                               const std::vector<std::vector<double>>& pass_seconds, const CostsOf& costs) {
  std::vector<Repeated> out(spec.mixes.size());
  for (uint64_t i = 0; i < plan.sure * tiles; ++i) {
    const uint64_t range = i / tiles, tile = i % tiles;
    const std::vector<PassRange> ranges = repilot_of(spec, plan, range, tile);
    if (ranges.empty()) continue;
    const std::vector<MixCost>* done = costs(i);
    for (size_t m = 0; m < spec.mixes.size(); ++m) {
      if (done == nullptr) {
        out[m].to_come += static_cast<double>(ranges[m].count()) * pass_seconds[m][tile];
        continue;
      }
      const MixCost& cost = (*done)[m];
      out[m].speed.passes += cost.repilot_passes;
      out[m].speed.seconds += cost.repilot_seconds;
      out[m].speed.foretold += static_cast<double>(cost.repilot_passes) * pass_seconds[m][tile];
    }
  }
  return out;
}

/// Whole groups that blocks have a part in are a little more than their shares of the passes: by this factor,
/// over the tiles of an automatic mix with these passes.
double rounding_of_blocks(const std::vector<PixelRect>& tiles, const AutoPlan& plan,
                          const std::vector<int64_t>& groups, const std::vector<int64_t>& passes) {
  double whole_groups = 0, shares = 0;
  for (size_t t = 0; t < tiles.size(); ++t) {
    whole_groups += block_passes_sum(tiles[t], plan.tiles[t].shares, groups[t], passes[t]);
    shares += static_cast<double>(passes[t]) * mean_share(tiles[t], plan.tiles[t].shares) *
              static_cast<double>(tiles[t].area());
  }
  return shares > 0 ? whole_groups / shares : 1;
}

/// The totals so far, as they are remembered.
EarlierPlan remembered(const PlannedPasses& planned) {
  EarlierPlan out{planned.open.front(), planned.passes, {}};
  for (const AutoPlan& plan : planned.autos) {
    out.autos.emplace_back();
    for (const TilePlan& tile : plan.tiles) out.autos.back().push_back(tile.passes);
  }
  return out;
}

/// Passes of each tile in the first `ranges` ranges.
std::vector<int64_t> passes_in(const Plan& plan, uint64_t ranges, size_t tiles, size_t mix) {
  std::vector<int64_t> out(tiles, 0);
  if (ranges == 0) return out;
  for (size_t t = 0; t < tiles; ++t) out[t] = run_range(plan, ranges - 1, t, mix).end;
  return out;
}

}  // namespace

std::vector<PassRange> repilot_of(const JobSpec& spec, const Plan& plan, uint64_t range, uint64_t tile) {
  const bool in_stages = !plan.planned.open.empty() || !plan.planned.earlier.empty();
  // A replay has nothing to find out.
  if (!in_stages || !spec.plan.empty() || plan.boundaries[range].share > kRepilotUntil) return {};
  std::vector<PassRange> out;
  for (size_t m = 0; m < spec.mixes.size(); ++m) {
    const double share = repilot_share(plan.planned, plan.tiles, m);
    const PassRange passes = run_range(plan, range, tile, m);
    const double offset = phase(tile * spec.mixes.size() + m);
    const auto before = [&](int64_t pass) {
      return static_cast<int64_t>(std::floor(share * static_cast<double>(pass) + offset));
    };
    out.push_back({before(passes.begin), before(passes.end)});
  }
  return out;
}

double expected_repilot_seconds(const JobSpec& spec) {
  const auto* cpu = std::get_if<CpuSecondsBudget>(&spec.budget);
  return cpu != nullptr && spec.plan.empty() ? kLeastRepilotShare * kRepilotUntil * cpu->seconds : 0;
}

double Speed::factor(double otherwise, double worth) const {
  if (passes < 1 || !(foretold > 0)) return otherwise;
  const double other = worth / (static_cast<double>(passes) + worth);
  return other * otherwise + (1 - other) * seconds / foretold;
}

absl::StatusOr<PlannedPasses> replanned(const JobSpec& spec, const std::vector<std::vector<MixCost>>& pilot,
                                        const PlannedPasses& planned, const CostsOf& costs) {
  PENUMBRA_CHECK(!planned.open.empty());
  const double budget = std::get<CpuSecondsBudget>(spec.budget).seconds;
  const std::vector<PixelRect> tiles = tiles_of(spec);
  const Plan plan = make_plan(spec, planned);
  ASSIGN_OR_RETURN(const auto foretold, pass_seconds(spec, tiles, pilot));
  const std::vector<Repeated> measured = repeated(spec, plan, tiles.size(), foretold, costs);
  Speed common;
  for (size_t m = 0; m < spec.mixes.size(); ++m) {
    if (spec.mixes[m].automatic) continue;
    common.passes += measured[m].speed.passes;
    common.seconds += measured[m].speed.seconds;
    common.foretold += measured[m].speed.foretold;
  }

  PlannedPasses next{{}, {}, planned.earlier, {planned.open.begin() + 1, planned.open.end()}};
  next.earlier.push_back(remembered(planned));
  for (size_t m = 0; m < spec.mixes.size(); ++m) {
    const std::vector<int64_t> sure = passes_in(plan, plan.sure, tiles.size(), m);
    if (!spec.mixes[m].automatic) {
      ASSIGN_OR_RETURN(
          const int64_t passes,
          passes_for_seconds(budget, pilot, m, measured[m].speed.factor(common.factor(), kRatioPasses)));
      next.passes.push_back(std::max(passes, sure[0]));
      continue;
    }
    const double factor = measured[m].speed.factor();
    // Repeated passes had the blocks of the first ones, of which whole groups are more than of all.
    const size_t a = next.autos.size();
    const AutoPlan& current = planned.autos[a];
    const double rounding =
        rounding_of_blocks(tiles, current, plan.groups[a],
                           passes_in(plan, plan.boundaries.size(), tiles.size(), m)) /
        rounding_of_blocks(tiles, current, plan.groups[a], passes_in(plan, plan.measured, tiles.size(), m));
    const AutoSpending spending{factor * rounding, measured[m].speed.seconds + measured[m].to_come * factor,
                                sure};
    ASSIGN_OR_RETURN(AutoPlan again, plan_auto(spec, tiles, pilot, next.autos.size(), spending));
    // What tiles do stays: their blocks have passes already. (A later version might choose otherwise.)
    again.candidates = current.candidates;
    for (size_t t = 0; t < tiles.size(); ++t) {
      again.tiles[t].candidate = current.tiles[t].candidate;
      again.tiles[t].shares = current.tiles[t].shares;
    }
    next.passes.push_back(mean_passes(spec, tiles, again));
    next.autos.push_back(std::move(again));
  }
  return next;
}

}  // namespace penumbra

#include "server/planner.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "proto/auto_plan.h"
#include "proto/blocks.h"
#include "proto/status.h"
#include "server/auto_planner.h"
#include "server/replanner.h"

namespace penumbra {
namespace {

// The pilot of a CPU-seconds budget may cost this share of it.
constexpr double kPilotShare = 0.05;
// Passes after which even a cheap pilot knows the cost of a pass well enough.
constexpr int64_t kMostPilotPasses = 256;
// Passes of a target-error pilot: the variance of one pass is then known to 1/√(2·(8−1)) per pixel and
// far better in the mean over pixels.
constexpr int64_t kVariancePilotPasses = 8;
// Whole passes of a tile by one of `auto`'s candidates, where there is time for them: together with the other
// pixels of its block each tells enough of what varies there.
constexpr int64_t kLevelPasses = 4;
// Groups of passes in a run. Fewer and larger groups stratify better; the variance needs several.
constexpr int64_t kLeastGroups = 4;
// Tasks as long as these are cheap to administer and short enough to keep all cores busy to the end.
constexpr double kLeastTaskSeconds = 0.2, kMostTaskSeconds = 0.8;
constexpr double kTasksPerRun = 256;
// Ranges of a tile: an endless run gets longer tasks rather than millions of them.
constexpr double kMostRanges = 1024;
// Tasks of a job, which the coordinator holds in memory.
constexpr double kMostTasks = 1 << 21;
// A group is rendered within one task, so that it may not grow beyond this.
constexpr double kMostGroupSeconds = 2;
// CPU time of one ray and its shading where no measurement may be used. Only sets the size of tasks.
constexpr double kNominalSecondsPerRay = 1e-6;
// Where a timeline looks, as shares of all passes. Nearly geometric.
constexpr double kCheckpoints[] = {1 / 32., 2 / 32.,  3 / 32.,  4 / 32.,  6 / 32.,
                                   8 / 32., 12 / 32., 16 / 32., 24 / 32., 1};

// A run whose tiles take less than this looks only where passes double: tasks would be too short to pay
// for their administration.
constexpr double kLeastSecondsForAllCheckpoints = 1;

/// Mixes bits of a tile's and a range's number into a seed (the finaliser of SplitMix64, Steele et al.
/// 2014); only the interleaving of slices depends on it.
uint64_t scramble(uint64_t seed, uint64_t value) {
  uint64_t z = seed + (value + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// Light samples of a pass of `auto`, before it is known what it will choose.
constexpr int kNominalSamples = 4;

/// CPU seconds that all mixes together are expected to spend on the image. For a CPU-seconds budget that
/// is what the budget says; otherwise counted rays.
double expected_seconds(const JobSpec& spec, const std::vector<int64_t>& passes) {
  if (const auto* cpu = std::get_if<CpuSecondsBudget>(&spec.budget))
    return cpu->seconds * static_cast<double>(spec.mixes.size());
  double rays = 0;
  for (size_t m = 0; m < passes.size(); ++m)
    rays += static_cast<double>(passes[m]) *
            (1 + (spec.mixes[m].automatic ? kNominalSamples : spec.mixes[m].samples()));
  return rays * static_cast<double>(spec.crop.area()) * kNominalSecondsPerRay;
}

/// For a run of at least `least` passes. Power of two, so that the patterns of a group are complete nets; 1
/// for independent samples, whose variance is best known from single passes.
int64_t choose_group(const JobSpec& spec, int64_t least, double seconds_per_pass) {
  if (spec.sampler == SamplerKind::kIndependent) return 1;
  if (spec.probe) return 1;  // its passes are repetitions
  int64_t group = 1;
  while (2 * group * kLeastGroups <= least &&
         static_cast<double>(2 * group) * seconds_per_pass <= kMostGroupSeconds)
    group *= 2;
  return group;
}

/// For a tile of an automatic mix: its blocks have few passes where their share is small, and the variance of
/// each needs two groups at least.
int64_t choose_group(const JobSpec& spec, const TilePlan& tile, double seconds_per_pass) {
  if (tile.shares.empty()) return choose_group(spec, tile.passes, seconds_per_pass);
  const int smallest = *std::min_element(tile.shares.begin(), tile.shares.end());
  const int64_t least = tile.passes * smallest / kWholeShare;
  return choose_group(spec, std::min(tile.passes, least * kLeastGroups / 2), seconds_per_pass);
}

struct Share {
  double share;
  bool checkpoint;
};

/// Where something must end: checkpoints, and the borders of stages.
std::vector<Share> marks(bool few, const std::vector<double>& borders) {
  std::vector<Share> marks;
  for (const double checkpoint : kCheckpoints)
    if (!few || std::exp2(std::round(std::log2(checkpoint))) == checkpoint)
      marks.push_back({checkpoint, true});
  for (const double border : borders) {
    const auto at =
        std::find_if(marks.begin(), marks.end(), [&](const Share& s) { return s.share >= border; });
    if (at->share != border) marks.insert(at, {border, false});
  }
  return marks;
}

/// Marks, and between them as many cuts as keep tasks short.
std::vector<Share> boundary_shares(double first_share, double tile_seconds, double task_seconds,
                                   const std::vector<double>& borders) {
  std::vector<Share> shares;
  // A very long run shows its first group without waiting for 1/32 of everything.
  if (first_share < kCheckpoints[0] / 4) shares.push_back({first_share, true});
  for (const Share& mark : marks(tile_seconds < kLeastSecondsForAllCheckpoints, borders)) {
    const double from = shares.empty() ? 0 : shares.back().share;
    const double cuts = std::ceil((mark.share - from) * tile_seconds / task_seconds);
    for (double cut = 1; cut < cuts; ++cut)
      shares.push_back({from + (mark.share - from) * cut / cuts, false});
    shares.push_back(mark);
  }
  return shares;
}

/// Passes of the mixes that have the same in every pixel; of all mixes, if there is no such.
std::vector<int64_t> common_passes(const JobSpec& spec, const std::vector<int64_t>& passes) {
  std::vector<int64_t> common;
  for (size_t m = 0; m < passes.size(); ++m)
    if (!spec.mixes[m].automatic) common.push_back(passes[m]);
  return common.empty() ? passes : common;
}

/// Mean over the pixels of what tiles' passes are to their blocks, which have a part in whole groups of them;
/// rounded.
int64_t mean_over_pixels(const JobSpec& spec, const std::vector<PixelRect>& tiles, const AutoPlan& plan,
                         const std::vector<int64_t>& groups, const std::vector<int64_t>& passes) {
  double sum = 0;
  for (size_t t = 0; t < tiles.size(); ++t)
    sum += block_passes_sum(tiles[t], plan.tiles[t].shares, groups[t], passes[t]);
  return std::llround(sum / static_cast<double>(spec.crop.area()));
}

/// Passes of a tile at a share. The first range has a group of every tile, however few passes that tile has:
/// then there is a whole picture.
int64_t auto_passes_at(double share, const Plan& plan, size_t automatic, size_t tile) {
  const std::vector<Stage> stages = stages_of(plan.planned, automatic, tile);
  const int64_t group = plan.groups[automatic][tile];
  return std::max(std::min(group, stages.front().total), passes_at(share, stages, group));
}

/// Of all tiles of all automatic mixes.
std::vector<std::vector<int64_t>> auto_passes_at(double share, const Plan& plan) {
  std::vector<std::vector<int64_t>> passes(plan.groups.size());
  for (size_t a = 0; a < plan.groups.size(); ++a)
    for (size_t t = 0; t < plan.groups[a].size(); ++t) passes[a].push_back(auto_passes_at(share, plan, a, t));
  return passes;
}

absl::StatusOr<int64_t> passes_for_error(double relmse, const JobSpec& spec,
                                         const std::vector<std::vector<MixCost>>& pilot, size_t mix) {
  double sum = 0;
  for (const std::vector<MixCost>& tile : pilot) {
    if (tile.size() <= mix || tile[mix].passes < 2)
      return make_status(absl::StatusCode::kInternal, "a pilot task of mix {} has no variance", mix);
    sum += tile[mix].relative_variance;
  }
  const double one_pass = sum / (3.0 * static_cast<double>(spec.crop.area()));
  constexpr double kMost = 1e12;
  return std::max<int64_t>(2, static_cast<int64_t>(std::ceil(std::min(one_pass / relmse, kMost))));
}

}  // namespace

bool needs_pilot(const JobSpec& spec) {
  return spec.plan.empty() &&
         (!std::holds_alternative<SppBudget>(spec.budget) || !automatic_mixes(spec.mixes).empty());
}

absl::StatusOr<int64_t> passes_for_seconds(double budget, const std::vector<std::vector<MixCost>>& pilot,
                                           size_t mix, double factor) {
  double seconds_per_pass = 0;
  for (const std::vector<MixCost>& tile : pilot) {
    if (tile.size() <= mix || tile[mix].passes < 1)
      return make_status(absl::StatusCode::kInternal, "a pilot task of mix {} has rendered no pass", mix);
    seconds_per_pass += tile[mix].cpu_seconds / static_cast<double>(tile[mix].passes);
  }
  seconds_per_pass *= factor;
  if (!(seconds_per_pass > 0))
    return make_status(absl::StatusCode::kInternal, "the pilot of mix {} has taken no time", mix);
  constexpr double kMost = 1e12;  // far beyond any run; keeps the conversion defined
  return std::max<int64_t>(1, std::llround(std::min(budget / seconds_per_pass, kMost)));
}

int64_t mean_passes(const JobSpec& spec, const std::vector<PixelRect>& tiles, const AutoPlan& plan) {
  double sum = 0;
  for (size_t t = 0; t < tiles.size(); ++t)
    sum += static_cast<double>(plan.tiles[t].passes) * mean_share(tiles[t], plan.tiles[t].shares) *
           static_cast<double>(tiles[t].area());
  return std::max<int64_t>(1, std::llround(sum / static_cast<double>(spec.crop.area())));
}

TileTask pilot_task(const JobSpec& spec, const std::vector<PixelRect>& tiles, uint64_t index) {
  PENUMBRA_CHECK(index < tiles.size());
  TileTask task;
  task.id = index;
  task.kind = TaskKind::kPilot;
  task.tile = tiles[index];
  task.shuffle = scramble(spec.seed, index);
  int64_t passes = kVariancePilotPasses;
  if (const auto* cpu = std::get_if<CpuSecondsBudget>(&spec.budget)) {
    passes = kMostPilotPasses;
    // Tiles share by area, so that small ones at the edges do not cost more than their part.
    task.pilot_seconds = kPilotShare * cpu->seconds * static_cast<double>(task.tile.area()) /
                         static_cast<double>(spec.crop.area());
  }
  const bool measured = !std::holds_alternative<SppBudget>(spec.budget);
  for (const Mix& mix : spec.mixes)
    task.passes.push_back({0, measured ? (mix.automatic ? kLevelPasses : passes) : 0});
  for (const int m : automatic_mixes(spec.mixes))
    for (const Mix& candidate : auto_candidates()) task.chosen.push_back({m, candidate, 1});
  if (!task.chosen.empty()) task.pilot_blocks = pilot_blocks(spec, task.tile);
  return task;
}

size_t costs_of(const TileTask& task) {
  return task.passes.size() + (task.kind == TaskKind::kPilot ? task.chosen.size() : 0);
}

absl::StatusOr<PlannedPasses> planned_passes(const JobSpec& spec,
                                             const std::vector<std::vector<MixCost>>& pilot) {
  if (!spec.plan.empty()) return PlannedPasses{spec.plan, spec.auto_plans, spec.earlier_plans};
  PlannedPasses planned;
  planned.open = borders_of(spec);
  std::vector<int64_t>& passes = planned.passes;
  const std::vector<PixelRect> tiles = tiles_of(spec);
  for (size_t m = 0; m < spec.mixes.size(); ++m) {
    if (spec.mixes[m].automatic) {
      ASSIGN_OR_RETURN(AutoPlan plan, plan_auto(spec, tiles, pilot, planned.autos.size(),
                                                {1, expected_repilot_seconds(spec)}));
      passes.push_back(mean_passes(spec, tiles, plan));
      planned.autos.push_back(std::move(plan));
    } else if (const auto* spp = std::get_if<SppBudget>(&spec.budget)) {
      passes.push_back(spp->passes);
    } else if (const auto* cpu = std::get_if<CpuSecondsBudget>(&spec.budget)) {
      ASSIGN_OR_RETURN(const int64_t count, passes_for_seconds(cpu->seconds, pilot, m));
      passes.push_back(count);
    } else {
      const double relmse = std::get<TargetErrorBudget>(spec.budget).relmse;
      ASSIGN_OR_RETURN(const int64_t count, passes_for_error(relmse, spec, pilot, m));
      passes.push_back(count);
    }
  }
  return planned;
}

absl::Status check_stages(const JobSpec& spec, const PlannedPasses& planned) {
  const std::vector<PixelRect> tiles = tiles_of(spec);
  for (const AutoPlan& plan : planned.autos) {
    if (plan.tiles.size() != tiles.size())
      return invalid_input("auto_plans: {} tiles, where the job has {}", plan.tiles.size(), tiles.size());
    for (size_t t = 0; t < tiles.size(); ++t)
      if (!shares_fit(tiles[t], plan.tiles[t].shares))
        return invalid_input("auto_plans: tile {}: {} shares for {} blocks, or one is 0", t,
                             plan.tiles[t].shares.size(), block_count(tiles[t]));
  }
  for (const EarlierPlan& plan : planned.earlier)
    for (const std::vector<int64_t>& passes : plan.autos)
      if (passes.size() != tiles.size())
        return invalid_input("earlier_plans: {} tiles, where the job has {}", passes.size(), tiles.size());
  if (planned.earlier.empty()) return absl::OkStatus();
  // At a border the totals of the stages before and after must not lie below what is rendered there.
  const Plan plan = make_plan(spec, planned);
  for (size_t i = 1; i < plan.boundaries.size(); ++i)
    for (size_t t = 0; t < tiles.size(); ++t)
      for (size_t m = 0; m < spec.mixes.size(); ++m)
        if (run_range(plan, i, t, m).count() < 0)
          return invalid_input("earlier_plans: mix {} has more passes at a border than in all", m);
  for (size_t m = 0; m < spec.mixes.size(); ++m)
    if (!spec.mixes[m].automatic && plan.boundaries.back().passes[m] != planned.passes[m])
      return invalid_input("earlier_plans: mix {} has more passes at a border than in all", m);
  return absl::OkStatus();
}

/// The totals that were planned first: they decide what must be the same in all stages.
static PlannedPasses first_plan(const PlannedPasses& planned) {
  if (planned.earlier.empty()) return planned;
  PlannedPasses first{planned.earlier[0].passes, planned.autos};
  for (size_t a = 0; a < first.autos.size(); ++a)
    for (size_t t = 0; t < first.autos[a].tiles.size(); ++t)
      first.autos[a].tiles[t].passes = planned.earlier[0].autos[a][t];
  return first;
}

/// Borders of all stages, past and open.
static std::vector<double> all_borders(const PlannedPasses& planned) {
  std::vector<double> borders;
  for (const EarlierPlan& plan : planned.earlier) borders.push_back(plan.until);
  borders.insert(borders.end(), planned.open.begin(), planned.open.end());
  return borders;
}

/// The boundaries of a plan whose groups are known.
static void add_boundaries(const JobSpec& spec, Plan& plan, const std::vector<Share>& shares) {
  const std::vector<PixelRect> tiles = tiles_of(spec);
  plan.tiles = tiles.size();
  std::vector<int64_t> before(spec.mixes.size(), 0);
  std::vector<std::vector<int64_t>> before_autos(plan.groups.size(), std::vector<int64_t>(tiles.size(), 0));
  for (const auto& [share, checkpoint] : shares) {
    PassBoundary boundary{{}, checkpoint, share};
    std::vector<std::vector<int64_t>> now = auto_passes_at(share, plan);
    size_t automatic = 0;
    for (size_t m = 0; m < spec.mixes.size(); ++m) {
      if (spec.mixes[m].automatic) {
        boundary.passes.push_back(mean_over_pixels(spec, tiles, plan.planned.autos[automatic],
                                                   plan.groups[automatic], now[automatic]));
        ++automatic;
      } else {
        boundary.passes.push_back(
            std::max(before[m], passes_at(share, stages_of(plan.planned, m), plan.group)));
      }
    }
    if (now == before_autos && boundary.passes == before) {
      // Too few passes for this cut: the boundary that is already there serves the checkpoint.
      if (checkpoint && !plan.boundaries.empty()) plan.boundaries.back().checkpoint = true;
      continue;
    }
    before = boundary.passes;
    before_autos = std::move(now);
    plan.boundaries.push_back(std::move(boundary));
  }
}

Plan make_plan(const JobSpec& spec, const PlannedPasses& planned) {
  PENUMBRA_CHECK(planned.passes.size() == spec.mixes.size());
  PENUMBRA_CHECK(planned.autos.size() == automatic_mixes(spec.mixes).size());
  Plan plan;
  plan.planned = planned;
  const PlannedPasses first = first_plan(planned);
  const std::vector<int64_t>& passes = first.passes;
  const double seconds = expected_seconds(spec, passes);
  // Of a full tile: smaller ones at the edges must not shrink the tasks of all others.
  const double tile_area =
      std::min<double>(static_cast<double>(spec.tile) * spec.tile, static_cast<double>(spec.crop.area()));
  const double tile_seconds = seconds * tile_area / static_cast<double>(spec.crop.area());
  const double most = static_cast<double>(*std::max_element(passes.begin(), passes.end()));
  const std::vector<int64_t> common = common_passes(spec, passes);
  plan.group = choose_group(spec, *std::min_element(common.begin(), common.end()), tile_seconds / most);
  // Each tile of an automatic mix has groups of its own size: of few passes where few are planned.
  for (const AutoPlan& a : first.autos) {
    plan.groups.emplace_back();
    for (const TilePlan& tile : a.tiles)
      plan.groups.back().push_back(choose_group(spec, tile, tile_seconds / most));
  }
  const double most_ranges = std::min(kMostRanges, kMostTasks / static_cast<double>(tile_count(spec)));
  const double task_seconds = std::max(
      std::clamp(seconds / kTasksPerRun, kLeastTaskSeconds, kMostTaskSeconds), tile_seconds / most_ranges);
  add_boundaries(spec, plan,
                 boundary_shares(static_cast<double>(plan.group) / most, tile_seconds, task_seconds,
                                 all_borders(planned)));
  // With large groups the cuts are few: then each of them is worth a look.
  if (tile_seconds >= kLeastSecondsForAllCheckpoints && plan.boundaries.size() <= std::size(kCheckpoints))
    for (PassBoundary& boundary : plan.boundaries) boundary.checkpoint = true;
  plan.boundaries.back().checkpoint = true;
  const auto up_to = [&](double share) {
    return static_cast<uint64_t>(std::count_if(plan.boundaries.begin(), plan.boundaries.end(),
                                               [&](const PassBoundary& b) { return b.share <= share; }));
  };
  plan.sure = up_to(planned.open.empty() ? 1 : planned.open.front());
  plan.measured = planned.open.empty() ? 0 : up_to(measured_share(planned.earlier));
  return plan;
}

uint64_t task_count(const Plan& plan, const std::vector<PixelRect>& tiles) {
  return plan.boundaries.size() * tiles.size();
}

PassRange run_range(const Plan& plan, uint64_t range, uint64_t tile, size_t mix) {
  for (size_t a = 0; a < plan.planned.autos.size(); ++a) {
    if (plan.planned.autos[a].mix != static_cast<int>(mix)) continue;
    return {range == 0 ? 0 : auto_passes_at(plan.boundaries[range - 1].share, plan, a, tile),
            auto_passes_at(plan.boundaries[range].share, plan, a, tile)};
  }
  return {range == 0 ? 0 : plan.boundaries[range - 1].passes[mix], plan.boundaries[range].passes[mix]};
}

TileTask run_task(const JobSpec& spec, const Plan& plan, const std::vector<PixelRect>& tiles,
                  uint64_t first_id, uint64_t index) {
  PENUMBRA_CHECK(index < task_count(plan, tiles));
  const uint64_t range = index / tiles.size();
  TileTask task;
  task.id = first_id + index;
  const uint64_t tile = index % tiles.size();
  task.tile = tiles[tile];
  for (size_t m = 0; m < spec.mixes.size(); ++m) task.passes.push_back(run_range(plan, range, tile, m));
  task.group = plan.group;
  for (size_t a = 0; a < plan.planned.autos.size(); ++a) {
    const AutoPlan& planned = plan.planned.autos[a];
    task.chosen.push_back({planned.mix, planned.candidates[planned.tiles[tile].candidate],
                           plan.groups[a][tile], planned.tiles[tile].shares});
  }
  task.repilot = repilot_of(spec, plan, range, tile);
  task.shuffle = scramble(spec.seed, first_id + index);
  return task;
}

}  // namespace penumbra

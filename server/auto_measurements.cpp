#include "server/auto_measurements.h"

#include <algorithm>

#include "proto/auto_plan.h"
#include "proto/status.h"

namespace penumbra {
namespace {

/// How much more a whole pass costs than the candidates' few pixels say, which are soon warm in caches; 1
/// where no tile has made one.
double whole_pass_factor(const JobSpec& spec, const std::vector<PixelRect>& tiles,
                         const std::vector<std::vector<MixCost>>& pilot, size_t mix, size_t first) {
  double whole = 0, blocks = 0;
  for (size_t t = 0; t < pilot.size(); ++t) {
    const MixCost& pass = pilot[t][mix];
    const MixCost& block = pilot[t][first + static_cast<size_t>(pass.candidate)];
    if (pass.passes < 1 || block.pixels < 1) continue;
    whole += pass.cpu_seconds / static_cast<double>(pass.passes);
    blocks += block.cpu_seconds / (static_cast<double>(block.pixels) * static_cast<double>(block.passes)) *
              static_cast<double>(tiles[t].area());
  }
  return std::holds_alternative<CpuSecondsBudget>(spec.budget) && whole > 0 && blocks > 0 ? whole / blocks
                                                                                          : 1;
}

}  // namespace

absl::StatusOr<Measurements> measurements(const JobSpec& spec, const std::vector<PixelRect>& tiles,
                                          const std::vector<std::vector<MixCost>>& pilot, size_t number) {
  const size_t candidates = auto_candidates().size();
  const size_t first = spec.mixes.size() + number * candidates;
  const auto mix = static_cast<size_t>(automatic_mixes(spec.mixes)[number]);
  const bool counted = std::holds_alternative<SppBudget>(spec.budget);
  Measurements out;
  for (const std::vector<MixCost>& tile : pilot) {
    if (tile.size() < first + candidates || tile[mix].candidate < 0 ||
        static_cast<size_t>(tile[mix].candidate) >= candidates)
      return make_status(absl::StatusCode::kInternal, "a pilot task of `auto` has measured {} mixes of {}",
                         tile.size(), first + candidates);
    out.pilot_seconds += tile[mix].cpu_seconds;
    std::vector<int> measured;
    std::vector<double> variance, worth, counts, cost;
    bool lobed = false;
    for (size_t k = 0; k < candidates; ++k) {
      const MixCost& c = tile[first + k];
      out.pilot_seconds += c.cpu_seconds + c.overhead_seconds;
      if (c.pixels < 1 || c.passes < 2) continue;
      const double pixels = static_cast<double>(c.pixels);
      measured.push_back(static_cast<int>(k));
      lobed |= c.lobed_pixels > 0;
      variance.push_back(c.relative_variance / pixels);
      cost.push_back((counted ? c.work : c.cpu_seconds) / (pixels * static_cast<double>(c.passes)));
      counts.push_back(pixels);
      const double sum = c.relative_variance, squares = c.relative_variance_squares;
      worth.push_back(squares > 0 ? std::min(pixels, sum * sum / squares) : pixels);
    }
    if (measured.empty() || (!out.candidates.empty() && measured != out.candidates))
      return make_status(absl::StatusCode::kInternal,
                         "a pilot task of `auto` has measured nothing to compare");
    out.lobed.push_back(lobed);
    out.blocks.push_back(tile[mix].blocks);
    out.candidates = std::move(measured);
    out.variance.push_back(std::move(variance));
    out.worth.push_back(std::move(worth));
    out.measured.push_back(std::move(counts));
    out.cost.push_back(std::move(cost));
  }
  const double factor = whole_pass_factor(spec, tiles, pilot, mix, first);
  for (std::vector<double>& tile : out.cost)
    for (double& cost : tile) cost *= factor;
  for (const std::vector<double>& tile : out.cost)
    if (!(*std::min_element(tile.begin(), tile.end()) > 0))
      return make_status(absl::StatusCode::kInternal, "the pilot of `auto` has taken no time");
  return out;
}

}  // namespace penumbra

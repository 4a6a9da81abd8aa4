#include "client/gate_decision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "proto/status.h"

namespace penumbra {
namespace {

/// Shares of the parts, scaled to the total that is compared: run.json's own figure decides, its parts say
/// how sure it is.
std::vector<double> rescaled(const std::vector<double>& parts, double total) {
  double sum = 0;
  for (const double part : parts) sum += part;
  std::vector<double> out;
  for (const double part : parts) out.push_back(part / sum * total);
  return out;
}

/// From a 95 % interval on the log scale. Its degrees of freedom were used up in making it.
std::optional<double> standard_error_of(const std::optional<ConfidenceInterval>& ci) {
  if (!ci || !(ci->low > 0) || !std::isfinite(ci->high)) return std::nullopt;
  return std::log(ci->high / ci->low) / (2 * normal_quantile(0.975));
}

/// Without parts that pair up, each run's own interval says how sure its figure is.
std::optional<Estimate> unpaired(double now, double before, const GateFigures& a, const GateFigures& b) {
  const auto sa = standard_error_of(a.relmse_ci), sb = standard_error_of(b.relmse_ci);
  if (!sa || !sb) return std::nullopt;
  // Where the floor was taken off, the same absolute error is a larger share of what is left.
  const double ea = *sa * *a.relmse / now, eb = *sb * *b.relmse / before;
  return Estimate{std::log(now / before), std::sqrt(ea * ea + eb * eb),
                  std::numeric_limits<double>::infinity()};
}

/// Figures × passes instead of figures: what the log ratio of the figures lacks.
Estimate passes_ratio(const GateFigures& now, const GateFigures& before) {
  return {std::log(now.passes / before.passes), 0, std::numeric_limits<double>::infinity()};
}

bool know_blocks(const GateFigures& a, const GateFigures& b) {
  return a.block_relmse.size() >= 2 && a.block_relmse.size() == b.block_relmse.size();
}

bool know_variance(const GateFigures& a, const GateFigures& b) {
  return a.variance && b.variance && *a.variance > 0 && *b.variance > 0 && a.block_variance.size() >= 2 &&
         a.block_variance.size() == b.block_variance.size();
}

/// relMSE of both, less the reference's floor where both know it.
std::pair<double, double> floors_off(const GateFigures& now, const GateFigures& before) {
  const bool both = now.floor && before.floor;
  return {*now.relmse - (both ? *now.floor : 0), *before.relmse - (both ? *before.floor : 0)};
}

/// Blocks of relMSE that sum up to `above` once the floor is taken off evenly.
std::vector<double> blocks_above(const GateFigures& figures, double above) {
  std::vector<double> blocks = rescaled(figures.block_relmse, *figures.relmse);
  const double floor = (*figures.relmse - above) / static_cast<double>(blocks.size());
  for (double& v : blocks) v -= floor;
  return blocks;
}

}  // namespace

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::kPass:
      return "pass";
    case Verdict::kWorse:
      return "worse";
    case Verdict::kInconclusive:
      return "inconclusive";
  }
  std::abort();
}

Verdict judge(const Estimate& log_ratio, double tolerance, int64_t figures) {
  PENUMBRA_CHECK(tolerance > 0);
  const double limit = std::log1p(tolerance);
  // One-sided bounds are ends of two-sided intervals of twice the level.
  const double alarm = sidak(kFalseAlarms, figures);
  if (interval(log_ratio, 1 - 2 * alarm).low > limit) return Verdict::kWorse;
  if (interval(log_ratio, 1 - 2 * kMissed).high < limit) return Verdict::kPass;
  return Verdict::kInconclusive;
}

Verdict worst(const std::vector<Verdict>& verdicts) {
  const auto any = [&](Verdict v) {
    return std::find(verdicts.begin(), verdicts.end(), v) != verdicts.end();
  };
  if (any(Verdict::kWorse)) return Verdict::kWorse;
  return verdicts.empty() || any(Verdict::kInconclusive) ? Verdict::kInconclusive : Verdict::kPass;
}

LogRatio error_ratio(const GateFigures& now, const GateFigures& before) {
  if (!now.relmse || !before.relmse) return {{}, "no error figure without a reference"};
  const Estimate passes = passes_ratio(now, before);
  if (*now.relmse == 0 && *before.relmse == 0) return {passes, ""};
  std::optional<Estimate> ratio;
  if (know_variance(now, before)) {
    ratio = paired_log_ratio(rescaled(now.block_variance, *now.variance),
                             rescaled(before.block_variance, *before.variance));
  } else {
    const auto [a, b] = floors_off(now, before);
    if (!(a > 0 && b > 0)) return {{}, "the error lies at the reference's noise floor"};
    ratio = know_blocks(now, before) ? paired_log_ratio(blocks_above(now, a), blocks_above(before, b))
                                     : unpaired(a, b, now, before);
  }
  if (!ratio) return {{}, "nothing says how sure the error figures are"};
  return {sum(*ratio, passes), ""};
}

std::optional<LogRatio> typical_ratio(const GateFigures& now, const GateFigures& before) {
  if (!know_variance(now, before)) return std::nullopt;
  const auto ratio = typical_log_ratio(now.block_variance, before.block_variance);
  if (!ratio) return LogRatio{{}, "too few places vary"};
  return LogRatio{sum(*ratio, passes_ratio(now, before)), ""};
}

std::optional<LogRatio> excess_ratio(const GateFigures& now, const GateFigures& before) {
  if (!now.relmse || !before.relmse || !know_variance(now, before) || !know_blocks(now, before))
    return std::nullopt;
  const auto [a, b] = floors_off(now, before);
  if (!(a > 0 && b > 0)) return LogRatio{{}, "the error lies at the reference's noise floor"};
  const std::vector<double> error_a = blocks_above(now, a), error_b = blocks_above(before, b);
  const std::vector<double> variance_a = rescaled(now.block_variance, *now.variance);
  const std::vector<double> variance_b = rescaled(before.block_variance, *before.variance);
  const auto ratio = paired_log_product(
      std::array{Factor{error_a, 1}, Factor{variance_a, -1}, Factor{error_b, -1}, Factor{variance_b, 1}});
  if (!ratio) return LogRatio{{}, "nothing says how sure the error figures are"};
  return LogRatio{ratio, ""};
}

LogRatio cpu_ratio(const GateFigures& now, const GateFigures& before, const Estimate& scale, bool measured) {
  if (!(now.cpu_seconds > 0 && before.cpu_seconds > 0)) return {{}, "no CPU time is recorded"};
  const Estimate per_pass{std::log(now.cpu_seconds / now.passes * before.passes / before.cpu_seconds), 0,
                          std::numeric_limits<double>::infinity()};
  Estimate ratio = sum(per_pass, scale);
  if (now.tile_seconds.size() >= 2 && now.tile_seconds.size() == before.tile_seconds.size()) {
    // Only its spread: the value is the one above.
    auto tiles = paired_log_ratio(rescaled(now.tile_seconds, 1), rescaled(before.tile_seconds, 1));
    if (tiles) {
      tiles->value = 0;
      if (!measured) tiles->standard_error *= std::sqrt(static_cast<double>(now.tile_seconds.size()));
      ratio = sum(ratio, *tiles);
    }
  }
  return {ratio, ""};
}

}  // namespace penumbra

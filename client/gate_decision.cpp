#include "client/gate_decision.h"

#include <algorithm>
#include <cmath>

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
  const bool both = now.floor && before.floor;
  const double floor_now = both ? *now.floor : 0, floor_before = both ? *before.floor : 0;
  const double a = *now.relmse - floor_now, b = *before.relmse - floor_before;
  const Estimate passes{std::log(now.passes / before.passes), 0, std::numeric_limits<double>::infinity()};
  if (*now.relmse == 0 && *before.relmse == 0) return {passes, ""};
  if (!(a > 0 && b > 0)) return {{}, "the error lies at the reference's noise floor"};
  std::optional<Estimate> ratio;
  if (now.block_relmse.size() >= 2 && now.block_relmse.size() == before.block_relmse.size()) {
    std::vector<double> blocks_a = rescaled(now.block_relmse, *now.relmse);
    std::vector<double> blocks_b = rescaled(before.block_relmse, *before.relmse);
    const double share = 1 / static_cast<double>(blocks_a.size());
    for (double& v : blocks_a) v -= floor_now * share;
    for (double& v : blocks_b) v -= floor_before * share;
    ratio = paired_log_ratio(blocks_a, blocks_b);
  } else {
    ratio = unpaired(a, b, now, before);
  }
  if (!ratio) return {{}, "nothing says how sure the error figures are"};
  return {sum(*ratio, passes), ""};
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

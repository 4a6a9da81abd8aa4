#pragma once
// Pass, worse or inconclusive: the decisions of `gate`, from confidence intervals alone. Pure.
#include <optional>
#include <string>
#include <vector>

#include "film/estimate.h"

namespace penumbra {

enum class Verdict { kPass, kWorse, kInconclusive };
/// "pass", "worse", "inconclusive".
std::string_view name_of(Verdict verdict);

/// Chance that any figure of a gate is called worse though none is, and that a figure passes though it is
/// worse than the tolerance.
inline constexpr double kFalseAlarms = 0.003;
inline constexpr double kMissed = 0.05;

/// Judges one of `figures` figures from log(new / old). With the tolerance t:
///   worse         the lower bound of the ratio lies above 1 + t, at a level of kFalseAlarms for all figures
///                 together (Šidák);
///   pass          the upper bound lies below 1 + t, at a level of kMissed;
///   inconclusive  neither: the run was too short or the machine too noisy to say.
/// A gate passes only if every figure does, so the second level needs no correction.
Verdict judge(const Estimate& log_ratio, double tolerance, int64_t figures);

/// Worse if any is worse; else inconclusive if any is; a gate of nothing is inconclusive.
Verdict worst(const std::vector<Verdict>& verdicts);

/// What a run says of one mix, ready to be compared. Parts (blocks of pixels, tiles) are the same in both
/// runs and independent; their sums need not have the scale of the totals, which are what is compared.
struct GateFigures {
  double passes = 0;
  std::optional<double> relmse;  ///< of the image
  std::optional<double> floor;   ///< of the reference
  std::optional<ConfidenceInterval> relmse_ci;
  std::vector<double> block_relmse;    ///< empty where unknown
  std::optional<double> variance;      ///< ErrorFigures::variance
  std::vector<double> block_variance;  ///< empty where unknown
  double cpu_seconds = 0;
  std::vector<double> tile_seconds;  ///< empty where unknown
};

/// A comparison that could be made, or why not.
struct LogRatio {
  std::optional<Estimate> estimate;
  std::string why_not;
};

/// Error per pass, new over old, for it falls as 1/passes in runs whose samples have the same patterns:
/// variance × passes where both runs know the variance of their blocks, else relMSE × passes. Of n groups of
/// passes variance has n - 1 squares a pixel and relMSE has one, so that it is that much surer; what it does
/// not see is excess_ratio()'s. From relMSE the reference's floor, which does not fall, is taken off where
/// both runs know it. The blocks, else the intervals, say how sure it is.
LogRatio error_ratio(const GateFigures& now, const GateFigures& before);

/// The ratio of variance × passes that is typical of the blocks (typical_log_ratio): a change that is in all
/// of the picture stands out here where a few outliers blur error_ratio(). Nothing where a run does not know
/// the variance of its blocks.
std::optional<LogRatio> typical_ratio(const GateFigures& now, const GateFigures& before);

/// (relMSE - floor) / variance, new over old. Each is 1 for an unbiased image and grows with the square of
/// its bias, or with what the samples have missed. A difference between reference and truth is in both.
/// Nothing where a run does not know the variance of its blocks.
std::optional<LogRatio> excess_ratio(const GateFigures& now, const GateFigures& before);

/// How much of its variance a run may add as bias²: less than that is not to be seen in pictures of 10^4
/// pixels, whose (relMSE - floor) / variance scatters by some percent.
inline constexpr double kExcessTolerance = 0.25;

/// CPU seconds per pass in units of a calibration loop, new over old. `scale`: log of (old seconds per unit /
/// new seconds per unit) with what is known of the noise between runs. Where that was `measured`, the tiles'
/// scatter is taken as their own and averages out; where it is only assumed, it is taken as the machine's
/// drift, which does not.
LogRatio cpu_ratio(const GateFigures& now, const GateFigures& before, const Estimate& scale, bool measured);

}  // namespace penumbra

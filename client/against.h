#pragma once
// `gate --against`: an old and a new build, interleaved on this machine.
#include <stop_token>

#include "client/gate_run.h"
#include "client/options.h"
#include "film/metrics.h"

namespace penumbra {

struct AgainstOptions {
  std::string other;  ///< folder of the other build
  JobOptions job;     ///< budget and passes are those of one round
  ClusterOptions cluster;
  int rounds = 8;
  bool quiet = false;
};

/// Renders `rounds` times with each build, in the order A B B A A B …, so that drift meets both alike; both
/// get the seeds seed, seed + 1, … A budget is turned into passes once, for all rounds of both. Error per
/// pass: block by block over the sum of the rounds. CPU per pass: mean of the rounds' log ratios; no
/// calibration is needed. InvalidArgument names the flag at fault.
absl::StatusOr<GateResult> gate_against(const AgainstOptions& against, const GateOptions& options,
                                        std::stop_token stop);

/// One build's sums over the rounds of one mix; apart from gate_against() for its test.
struct RoundSums {
  double passes = 0, relmse = 0;  ///< relmse, floor and blocks: means of figure × passes
  std::optional<double> floor;
  std::vector<double> block_relmse;
  std::optional<double> variance;  ///< of all rounds or of none
  std::vector<double> block_variance;
  std::vector<double> seconds_per_pass;  ///< one per round
  void add(const ErrorFigures& error, double round_passes, double cpu_seconds);
};
/// The rows of one mix.
std::vector<GateRow> rows_of(const std::string& mix, const RoundSums& now, const RoundSums& before,
                             const GateOptions& options, SamplerKind sampler);

}  // namespace penumbra

#pragma once
// run.json as `gate` reads it.
#include <optional>
#include <string>
#include <vector>

#include "client/gate_decision.h"
#include "client/job_json.h"

namespace penumbra {

/// How much CPU per pass in calibration units differs between runs of the same program: `calibrate` measures
/// it.
struct NoiseFloor {
  double cpu_log_sd = 0;  ///< standard deviation of log(CPU per pass) of one run
  double degrees_of_freedom = 1;
};
absl::StatusOr<NoiseFloor> noise_from_json(const Json& json);

struct GateOptions {
  double tolerance = 0.05;      ///< of error per pass
  double cpu_tolerance = 0.05;  ///< of CPU per pass
  std::optional<NoiseFloor> noise;
};

inline constexpr std::string_view kCpuPerPass = "CPU per pass";

struct GateRow {
  std::string mix, figure;  ///< "error per pass", "typical error", "error/variance" or kCpuPerPass
  std::optional<Estimate> log_ratio;
  double tolerance = 0;
  std::optional<Verdict> verdict;  ///< none: shown, not judged
  std::string note;
};

struct GateResult {
  Verdict verdict = Verdict::kInconclusive;
  std::vector<GateRow> rows;
  std::vector<std::string> notes;
};

/// Why two runs of these numbers of passes tell nothing of error per pass unless all samples are independent:
/// patterns are stratified over groups of passes whose size goes with the number of passes, and the last
/// group may be incomplete. With 15 passes after 16 the same program has up to 1.9 times the error per pass.
/// "" where they are equal.
std::string patterns_differ(double now, double before);

/// The rows of a mix that are about its error: error_ratio() and, where they are known, typical_ratio()
/// and excess_ratio(); or a single one that is not decided, and `why_not`.
std::vector<GateRow> error_rows(const std::string& mix, const GateFigures& now, const GateFigures& before,
                                const GateOptions& options, const std::string& why_not = "");

/// Judges the rows that have an estimate and no verdict yet, and the whole. Rows whose note says that they
/// are only shown keep no verdict.
void judge_rows(GateResult& result);

/// Compares a run with a baseline, mix by mix (by label). InvalidArgument where one of them is not a run.json
/// with error figures, where they do not show the same pixels of the same scene, or a mix of the baseline is
/// missing; `now_name` and `before_name` are the files, for messages.
absl::StatusOr<GateResult> gate_runs(const Json& now, const std::string& now_name, const Json& before,
                                     const std::string& before_name, const GateOptions& options);

/// What gate_runs() needs of a run and nothing else: no paths, no machine's name. To be kept with a project.
absl::StatusOr<Json> baseline_of(const Json& run, const std::string& name);

std::string gate_text(const GateResult& result);
Json gate_json(const GateResult& result);

}  // namespace penumbra

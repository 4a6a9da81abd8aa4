#include "client/against.h"

#include <algorithm>
#include <cmath>

#include "client/outcome.h"
#include "client/quiet_run.h"
#include "client/run_job.h"
#include "proto/status.h"

namespace penumbra {

void RoundSums::add(const ErrorFigures& error, double round_passes, double cpu_seconds) {
  passes += round_passes;
  relmse += error.relmse * round_passes;
  if (error.reference_floor) floor = floor.value_or(0) + *error.reference_floor * round_passes;
  const auto add_blocks = [&](std::vector<double>& sums, const std::vector<double>& blocks) {
    sums.resize(blocks.size(), 0);
    for (size_t b = 0; b < blocks.size(); ++b) sums[b] += blocks[b] * round_passes;
  };
  add_blocks(block_relmse, error.blocks.relmse);
  // A round without the variance leaves no variance of the sum.
  if (error.variance && (variance || seconds_per_pass.empty())) {
    variance = variance.value_or(0) + *error.variance * round_passes;
    add_blocks(block_variance, error.blocks.variance);
  } else {
    variance.reset();
    block_variance.clear();
  }
  seconds_per_pass.push_back(cpu_seconds / round_passes);
}

namespace {

/// Sums of figure × passes are figures per pass: of a run with one pass, up to a factor that both builds
/// share.
GateFigures per_pass(const RoundSums& sums) {
  GateFigures f;
  f.passes = 1;
  f.relmse = sums.relmse;
  f.floor = sums.floor;
  f.block_relmse = sums.block_relmse;
  f.variance = sums.variance;
  f.block_variance = sums.block_variance;
  return f;
}

struct Side {
  std::unique_ptr<Backend> backend;
  std::vector<RoundSums> mixes;
};

absl::StatusOr<FetchedRun> run_on(Side& side, const JobSpec& spec, std::stop_token stop) {
  return run_quietly(*side.backend->server, spec, stop,
                     [&](const JobStatus&) { return side.backend->tend(); });
}

absl::Status render_round(Side& side, const JobSpec& spec, const FilmImage& reference, std::stop_token stop) {
  ASSIGN_OR_RETURN(const FetchedRun run, run_on(side, spec, stop));
  for (size_t m = 0; m < spec.mixes.size(); ++m) {
    ASSIGN_OR_RETURN(const ErrorFigures error, compare(run.images[m], reference));
    side.mixes[m].add(error, static_cast<double>(run.summary.mixes[m].passes),
                      run.summary.mixes[m].cpu_seconds);
  }
  return absl::OkStatus();
}

/// A budget becomes passes once, on the old build, and both builds render as many: other numbers of passes
/// have other patterns of samples (patterns_differ). What was rendered for that counts for nothing. `auto`
/// plans anew each time.
absl::Status fix_passes(Side& side, JobSpec& spec, std::stop_token stop) {
  const bool automatic =
      std::any_of(spec.mixes.begin(), spec.mixes.end(), [](const Mix& mix) { return mix.automatic; });
  if (automatic || std::holds_alternative<SppBudget>(spec.budget)) return absl::OkStatus();
  ASSIGN_OR_RETURN(const FetchedRun run, run_on(side, spec, stop));
  for (const MixSummary& mix : run.summary.mixes) spec.plan.push_back(mix.passes);
  return absl::OkStatus();
}

absl::StatusOr<Side> open_side(const AgainstOptions& against, const std::string& programs,
                               const Submission& submission, std::stop_token stop) {
  Side side;
  absl::StatusOr<std::unique_ptr<Backend>> backend = open_local(against.cluster, programs);
  if (!backend.ok()) {
    if (programs.empty()) return backend.status();
    return make_status(backend.status().code(), "--against: {}", message_of(backend.status()));
  }
  side.backend = *std::move(backend);
  side.mixes.resize(submission.spec.mixes.size());
  RETURN_IF_ERROR(side.backend->server->upload(submission.bundle, stop));
  return side;
}

}  // namespace

std::vector<GateRow> rows_of(const std::string& mix, const RoundSums& now, const RoundSums& before,
                             const GateOptions& options, SamplerKind sampler) {
  const std::string why_not =
      sampler == SamplerKind::kIndependent ? "" : patterns_differ(now.passes, before.passes);
  std::vector<GateRow> rows = error_rows(mix, per_pass(now), per_pass(before), options, why_not);
  std::vector<double> cpu;
  for (size_t r = 0; r < now.seconds_per_pass.size(); ++r)
    cpu.push_back(std::log(now.seconds_per_pass[r] / before.seconds_per_pass[r]));
  const std::optional<Estimate> cost = mean_of(cpu);
  rows.push_back(
      {mix, std::string(kCpuPerPass), cost, options.cpu_tolerance, {}, cost ? "" : "not judged: one round"});
  return rows;
}

absl::StatusOr<GateResult> gate_against(const AgainstOptions& against, const GateOptions& options,
                                        std::stop_token stop) {
  if (against.job.reference.empty())
    return invalid_input("--against needs --reference: without it nothing is known of the error");
  ASSIGN_OR_RETURN(const Submission submission, prepare(against.job));
  ASSIGN_OR_RETURN(const FilmImage reference, read_reference(submission.spec));
  Progress progress(Progress::style_for(against.quiet));
  for (const std::string& warning : submission.warnings) progress.note("warning: " + warning);
  ASSIGN_OR_RETURN(Side before, open_side(against, against.other, submission, stop));
  ASSIGN_OR_RETURN(Side now, open_side(against, "", submission, stop));
  JobSpec planned = submission.spec;
  RETURN_IF_ERROR(fix_passes(before, planned, stop));
  for (int round = 0; round < against.rounds; ++round) {
    JobSpec spec = planned;
    spec.seed += static_cast<uint64_t>(round);
    progress.note(fmt::format("round {} of {}", round + 1, against.rounds));
    Side& first = round % 2 == 0 ? before : now;
    Side& second = round % 2 == 0 ? now : before;
    RETURN_IF_ERROR(render_round(first, spec, reference, stop));
    RETURN_IF_ERROR(render_round(second, spec, reference, stop));
  }
  GateResult result;
  const std::vector<std::string> names = labels(submission.spec.mixes);
  for (size_t m = 0; m < names.size(); ++m)
    for (GateRow& row : rows_of(names[m], now.mixes[m], before.mixes[m], options, submission.spec.sampler))
      result.rows.push_back(std::move(row));
  judge_rows(result);
  return result;
}

}  // namespace penumbra

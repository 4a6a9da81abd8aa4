// Costs, reports and summaries.
#include "proto/convert.h"
#include "proto/convert_check.h"

namespace penumbra {

static absl::StatusOr<JobState> from_proto(v1::JobState state) {
  switch (state) {
    case v1::JOB_STATE_QUEUED:
      return JobState::kQueued;
    case v1::JOB_STATE_PILOT:
      return JobState::kPilot;
    case v1::JOB_STATE_RUNNING:
      return JobState::kRunning;
    case v1::JOB_STATE_DONE:
      return JobState::kDone;
    case v1::JOB_STATE_FAILED:
      return JobState::kFailed;
    case v1::JOB_STATE_CANCELLED:
      return JobState::kCancelled;
    default:
      return invalid_input("state: unknown value {}", static_cast<int>(state));
  }
}

static v1::JobState to_proto(JobState state) {
  switch (state) {
    case JobState::kQueued:
      return v1::JOB_STATE_QUEUED;
    case JobState::kPilot:
      return v1::JOB_STATE_PILOT;
    case JobState::kRunning:
      return v1::JOB_STATE_RUNNING;
    case JobState::kDone:
      return v1::JOB_STATE_DONE;
    case JobState::kFailed:
      return v1::JOB_STATE_FAILED;
    case JobState::kCancelled:
      return v1::JOB_STATE_CANCELLED;
  }
  std::abort();
}

static absl::StatusOr<FailureKind> from_proto(v1::FailureKind kind) {
  switch (kind) {
    case v1::FAILURE_KIND_UNSPECIFIED:
      return FailureKind::kNone;
    case v1::FAILURE_KIND_BAD_INPUT:
      return FailureKind::kBadInput;
    case v1::FAILURE_KIND_JOB_FAILED:
      return FailureKind::kJobFailed;
    default:
      return invalid_input("failure: unknown value {}", static_cast<int>(kind));
  }
}

static v1::FailureKind to_proto(FailureKind kind) {
  switch (kind) {
    case FailureKind::kNone:
      return v1::FAILURE_KIND_UNSPECIFIED;
    case FailureKind::kBadInput:
      return v1::FAILURE_KIND_BAD_INPUT;
    case FailureKind::kJobFailed:
      return v1::FAILURE_KIND_JOB_FAILED;
  }
  std::abort();
}

v1::Calibration to_proto(const Calibration& calibration) {
  v1::Calibration out;
  out.set_units(calibration.units);
  out.set_seconds(calibration.seconds);
  return out;
}

absl::StatusOr<Calibration> from_proto(const v1::Calibration& message) {
  RETURN_IF_ERROR(check_amount("calibration.seconds", message.seconds()));
  return Calibration{message.units(), message.seconds()};
}

v1::MixSummary to_proto(const MixSummary& mix) {
  v1::MixSummary out;
  out.set_mix(label(mix.mix));
  out.set_planned_passes(mix.planned_passes);
  out.set_passes(mix.passes);
  out.set_cpu_seconds(mix.cpu_seconds);
  out.set_rays(mix.rays);
  out.set_line_queries(mix.line_queries);
  out.set_non_finite(mix.non_finite);
  out.set_pilot_cpu_seconds(mix.pilot_cpu_seconds);
  *out.mutable_calibration() = to_proto(mix.calibration);
  for (const std::string& text : mix.substitutions) out.add_substitutions(text);
  for (const Checkpoint& checkpoint : mix.checkpoints) {
    v1::MixSummary::Checkpoint* added = out.add_checkpoints();
    added->set_passes(checkpoint.passes);
    added->set_cpu_seconds(checkpoint.cpu_seconds);
  }
  return out;
}

absl::StatusOr<MixSummary> from_proto(const v1::MixSummary& message) {
  MixSummary mix;
  ASSIGN_OR_RETURN(mix.mix, parse_mix(message.mix()));
  RETURN_IF_ERROR(check_range<int64_t>("planned_passes", message.planned_passes(), 0, kMostPasses));
  RETURN_IF_ERROR(check_range<int64_t>("passes", message.passes(), 0, kMostPasses));
  RETURN_IF_ERROR(check_amount("cpu_seconds", message.cpu_seconds()));
  RETURN_IF_ERROR(check_amount("pilot_cpu_seconds", message.pilot_cpu_seconds()));
  mix.planned_passes = message.planned_passes();
  mix.passes = message.passes();
  mix.cpu_seconds = message.cpu_seconds();
  mix.rays = message.rays();
  mix.line_queries = message.line_queries();
  mix.non_finite = message.non_finite();
  mix.pilot_cpu_seconds = message.pilot_cpu_seconds();
  ASSIGN_OR_RETURN(mix.calibration, from_proto(message.calibration()));
  ASSIGN_OR_RETURN(mix.substitutions, texts_from_proto("substitutions", message.substitutions()));
  for (const v1::MixSummary::Checkpoint& checkpoint : message.checkpoints()) {
    RETURN_IF_ERROR(check_range<int64_t>("checkpoints.passes", checkpoint.passes(), 0, kMostPasses));
    RETURN_IF_ERROR(check_amount("checkpoints.cpu_seconds", checkpoint.cpu_seconds()));
    mix.checkpoints.push_back({checkpoint.passes(), checkpoint.cpu_seconds()});
  }
  return mix;
}

v1::TileRow to_proto(const TileRow& row) {
  v1::TileRow out;
  *out.mutable_rect() = to_proto(row.rect);
  out.set_mix(row.mix);
  out.set_passes(row.passes);
  out.set_cpu_seconds(row.cpu_seconds);
  out.set_worker(row.worker);
  *out.mutable_calibration() = to_proto(row.calibration);
  return out;
}

absl::StatusOr<TileRow> from_proto(const v1::TileRow& message) {
  TileRow row;
  ASSIGN_OR_RETURN(row.rect, from_proto(message.rect()));
  RETURN_IF_ERROR(check_range<int64_t>("tiles.passes", message.passes(), 0, kMostPasses));
  RETURN_IF_ERROR(check_amount("tiles.cpu_seconds", message.cpu_seconds()));
  RETURN_IF_ERROR(check_text("tiles.worker", message.worker()));
  ASSIGN_OR_RETURN(row.calibration, from_proto(message.calibration()));
  row.mix = message.mix();
  row.passes = message.passes();
  row.cpu_seconds = message.cpu_seconds();
  row.worker = message.worker();
  return row;
}

v1::MixCost to_proto(const MixCost& cost) {
  v1::MixCost out;
  out.set_passes(cost.passes);
  out.set_cpu_seconds(cost.cpu_seconds);
  out.set_rays(cost.rays);
  out.set_line_queries(cost.line_queries);
  out.set_non_finite(cost.non_finite);
  out.set_relative_variance(cost.relative_variance);
  *out.mutable_calibration() = to_proto(cost.calibration);
  out.set_pixels(cost.pixels);
  out.set_relative_variance_squares(cost.relative_variance_squares);
  out.set_lobed_pixels(cost.lobed_pixels);
  out.set_work(cost.work);
  out.set_overhead_seconds(cost.overhead_seconds);
  out.set_repilot_passes(cost.repilot_passes);
  out.set_repilot_seconds(cost.repilot_seconds);
  out.set_candidate(cost.candidate);
  for (const BlockCost& block : cost.blocks) {
    v1::BlockCost* added = out.add_blocks();
    added->set_relative_deviation(block.relative_deviation);
    added->set_cpu_seconds(block.cpu_seconds);
  }
  return out;
}

absl::StatusOr<MixCost> from_proto(const v1::MixCost& message) {
  RETURN_IF_ERROR(check_range<int64_t>("costs.passes", message.passes(), 0, kMostPasses));
  RETURN_IF_ERROR(check_reported("costs.cpu_seconds", message.cpu_seconds()));
  RETURN_IF_ERROR(check_reported("costs.relative_variance", message.relative_variance()));
  RETURN_IF_ERROR(check_range<int64_t>("costs.pixels", message.pixels(), 0, int64_t{1} << 32));
  RETURN_IF_ERROR(check_reported("costs.relative_variance_squares", message.relative_variance_squares(),
                                 kMostReported * kMostReported));
  RETURN_IF_ERROR(check_range<int64_t>("costs.lobed_pixels", message.lobed_pixels(), 0, message.pixels()));
  RETURN_IF_ERROR(check_reported("costs.work", message.work()));
  RETURN_IF_ERROR(check_reported("costs.overhead_seconds", message.overhead_seconds()));
  RETURN_IF_ERROR(check_range<int64_t>("costs.repilot_passes", message.repilot_passes(), 0, kMostPasses));
  RETURN_IF_ERROR(check_reported("costs.repilot_seconds", message.repilot_seconds()));
  RETURN_IF_ERROR(check_count("costs.blocks", message.blocks_size()));
  MixCost cost;
  ASSIGN_OR_RETURN(cost.calibration, from_proto(message.calibration()));
  RETURN_IF_ERROR(check_reported("costs.calibration.seconds", cost.calibration.seconds));
  cost.passes = message.passes();
  cost.cpu_seconds = message.cpu_seconds();
  cost.rays = message.rays();
  cost.line_queries = message.line_queries();
  cost.non_finite = message.non_finite();
  cost.relative_variance = message.relative_variance();
  cost.pixels = message.pixels();
  cost.relative_variance_squares = message.relative_variance_squares();
  cost.lobed_pixels = message.lobed_pixels();
  cost.work = message.work();
  cost.overhead_seconds = message.overhead_seconds();
  cost.repilot_passes = message.repilot_passes();
  cost.repilot_seconds = message.repilot_seconds();
  cost.candidate = message.candidate();
  for (const v1::BlockCost& block : message.blocks()) {
    RETURN_IF_ERROR(check_reported("costs.blocks.relative_deviation", block.relative_deviation()));
    RETURN_IF_ERROR(check_reported("costs.blocks.cpu_seconds", block.cpu_seconds()));
    cost.blocks.push_back({block.relative_deviation(), block.cpu_seconds()});
  }
  return cost;
}

v1::LoadReport to_proto(const LoadReport& report) {
  v1::LoadReport out;
  out.set_parse_seconds(report.parse_seconds);
  out.set_build_seconds(report.build_seconds);
  for (const Need& need : report.needs) {
    v1::Need* added = out.add_needs();
    added->set_effect(need.effect);
    added->set_why(need.why);
  }
  for (const std::string& warning : report.warnings) out.add_warnings(warning);
  return out;
}

absl::StatusOr<LoadReport> from_proto(const v1::LoadReport& message) {
  LoadReport report;
  RETURN_IF_ERROR(check_amount("parse_seconds", message.parse_seconds()));
  RETURN_IF_ERROR(check_amount("build_seconds", message.build_seconds()));
  report.parse_seconds = message.parse_seconds();
  report.build_seconds = message.build_seconds();
  for (const v1::Need& need : message.needs()) {
    RETURN_IF_ERROR(check_text("needs.effect", need.effect()));
    RETURN_IF_ERROR(check_text("needs.why", need.why()));
    report.needs.push_back({need.effect(), need.why()});
  }
  ASSIGN_OR_RETURN(report.warnings, texts_from_proto("warnings", message.warnings()));
  return report;
}

v1::WorkerInfo to_proto(const WorkerInfo& worker) {
  v1::WorkerInfo out;
  out.set_id(worker.id);
  out.set_host(worker.host);
  out.set_isa(worker.isa);
  out.set_cores(worker.cores);
  return out;
}

absl::StatusOr<WorkerInfo> from_proto(const v1::WorkerInfo& message) {
  for (const std::string* text : {&message.id(), &message.host(), &message.isa()})
    RETURN_IF_ERROR(check_text("worker", *text, kMostIdentity));
  if (message.id().empty()) return invalid_input("worker.id: empty");
  RETURN_IF_ERROR(check_range("worker.cores", message.cores(), 1, 1 << 16));
  return WorkerInfo{message.id(), message.host(), message.isa(), message.cores()};
}

static v1::Faults to_proto(const FaultCounts& faults) {
  v1::Faults out;
  out.set_lost_leases(faults.lost_leases);
  out.set_overdue_leases(faults.overdue_leases);
  out.set_late_results(faults.late_results);
  out.set_refused_results(faults.refused_results);
  out.set_failures(faults.failures);
  out.set_returned_leases(faults.returned_leases);
  out.set_corrupt_results(faults.corrupt_results);
  return out;
}

static FaultCounts from_proto(const v1::Faults& message) {
  return {message.lost_leases(),     message.overdue_leases(), message.late_results(),
          message.refused_results(), message.failures(),       message.returned_leases(),
          message.corrupt_results()};
}

v1::JobTerms to_proto(const JobTerms& terms) {
  v1::JobTerms out;
  out.set_user(terms.user);
  out.set_priority(terms.priority);
  for (const std::string& label : terms.labels) out.add_labels(label);
  for (const JobId& job : terms.after) out.add_after(job);
  return out;
}

absl::StatusOr<JobTerms> from_proto(const v1::JobTerms& message) {
  constexpr int kMostPriority = 100, kMostListed = 64;
  constexpr size_t kMostName = 256;
  JobTerms terms;
  if (message.user().size() > kMostName) return invalid_input("user: longer than {} bytes", kMostName);
  RETURN_IF_ERROR(check_range("priority", message.priority(), -kMostPriority, kMostPriority));
  if (message.labels_size() > kMostListed) return invalid_input("labels: more than {}", kMostListed);
  if (message.after_size() > kMostListed) return invalid_input("after: more than {}", kMostListed);
  for (const std::string& label : message.labels())
    if (label.size() > kMostName || label.find('=') == 0 || label.find('=') == std::string::npos)
      return invalid_input("labels: '{:.80}' is not of the form KEY=VALUE", label);
  for (const std::string& job : message.after())
    if (job.empty() || job.size() > kMostName) return invalid_input("after: '{:.80}' is not a job", job);
  terms.user = message.user();
  terms.priority = message.priority();
  terms.labels = {message.labels().begin(), message.labels().end()};
  terms.after = {message.after().begin(), message.after().end()};
  return terms;
}

v1::LogResponse::Line to_proto(const LogLine& line) {
  v1::LogResponse::Line out;
  out.set_unix_seconds(line.unix_seconds);
  if (line.task) out.set_task(*line.task);
  out.set_worker(line.worker);
  out.set_text(line.text);
  return out;
}

absl::StatusOr<LogLine> from_proto(const v1::LogResponse::Line& message) {
  RETURN_IF_ERROR(check_amount("unix_seconds", message.unix_seconds()));
  RETURN_IF_ERROR(check_text("worker", message.worker()));
  RETURN_IF_ERROR(check_text("text", message.text()));
  LogLine line{message.unix_seconds(), std::nullopt, message.worker(), message.text()};
  if (message.has_task()) line.task = message.task();
  return line;
}

v1::JobStatus to_proto(const JobStatus& status) {
  v1::JobStatus out;
  out.set_job(status.job);
  out.set_state(to_proto(status.state));
  out.set_failure(to_proto(status.failure));
  out.set_message(status.message);
  out.set_fraction(status.fraction);
  out.set_tasks_done(status.tasks_done);
  out.set_tasks_total(status.tasks_total);
  out.set_tasks_leased(status.tasks_leased);
  out.set_cpu_seconds(status.cpu_seconds);
  out.set_pilot_cpu_seconds(status.pilot_cpu_seconds);
  out.mutable_plan()->Add(status.plan.begin(), status.plan.end());
  out.set_wall_seconds(status.wall_seconds);
  out.set_workers(status.workers);
  out.set_cores(status.cores);
  out.set_retries(status.retries);
  out.set_scene(status.scene);
  out.set_submitted_unix_seconds(status.submitted_unix_seconds);
  *out.mutable_faults() = to_proto(status.faults);
  *out.mutable_terms() = to_proto(status.terms);
  return out;
}

absl::StatusOr<JobStatus> from_proto(const v1::JobStatus& message) {
  JobStatus status;
  for (const std::string* text : {&message.job(), &message.message(), &message.scene()})
    RETURN_IF_ERROR(check_text("status", *text));
  ASSIGN_OR_RETURN(status.state, from_proto(message.state()));
  ASSIGN_OR_RETURN(status.failure, from_proto(message.failure()));
  ASSIGN_OR_RETURN(status.plan, passes_from_proto("plan", message.plan()));
  for (const double amount : {message.fraction(), message.cpu_seconds(), message.pilot_cpu_seconds(),
                              message.wall_seconds(), message.submitted_unix_seconds()})
    RETURN_IF_ERROR(check_amount("status", amount));
  status.job = message.job();
  status.message = message.message();
  status.fraction = message.fraction();
  status.tasks_done = message.tasks_done();
  status.tasks_total = message.tasks_total();
  status.tasks_leased = message.tasks_leased();
  status.cpu_seconds = message.cpu_seconds();
  status.pilot_cpu_seconds = message.pilot_cpu_seconds();
  status.wall_seconds = message.wall_seconds();
  status.workers = message.workers();
  status.cores = message.cores();
  status.retries = message.retries();
  status.scene = message.scene();
  status.submitted_unix_seconds = message.submitted_unix_seconds();
  status.faults = from_proto(message.faults());
  ASSIGN_OR_RETURN(status.terms, from_proto(message.terms()));
  return status;
}

v1::RunSummary to_proto(const RunSummary& summary) {
  v1::RunSummary out;
  *out.mutable_status() = to_proto(summary.status);
  *out.mutable_spec() = to_proto(summary.spec);
  for (const MixSummary& mix : summary.mixes) *out.add_mixes() = to_proto(mix);
  for (const TileRow& row : summary.tiles) *out.add_tiles() = to_proto(row);
  for (const WorkerInfo& worker : summary.workers) *out.add_workers() = to_proto(worker);
  *out.mutable_load() = to_proto(summary.load);
  out.set_worker_cpu_seconds(summary.worker_cpu_seconds);
  out.set_render_wall_seconds(summary.render_wall_seconds);
  out.set_total_wall_seconds(summary.total_wall_seconds);
  out.set_first_result_seconds(summary.first_result_seconds);
  for (const AutoPlan& plan : summary.auto_plans) *out.add_auto_plans() = to_proto(plan);
  for (const EarlierPlan& plan : summary.earlier_plans) *out.add_earlier_plans() = to_proto(plan);
  return out;
}

absl::StatusOr<RunSummary> from_proto(const v1::RunSummary& message) {
  RunSummary summary;
  ASSIGN_OR_RETURN(summary.status, from_proto(message.status()));
  ASSIGN_OR_RETURN(summary.spec, from_proto(message.spec()));
  ASSIGN_OR_RETURN(summary.mixes, list_from_proto<MixSummary>("mixes", message.mixes()));
  if (summary.mixes.size() != summary.spec.mixes.size())
    return invalid_input("mixes: {} summaries for {} mixes", summary.mixes.size(), summary.spec.mixes.size());
  ASSIGN_OR_RETURN(summary.auto_plans, auto_plans_from_proto(message.auto_plans(), summary.spec.mixes));
  ASSIGN_OR_RETURN(summary.earlier_plans,
                   earlier_plans_from_proto(message.earlier_plans(), summary.spec.mixes));
  ASSIGN_OR_RETURN(summary.tiles, list_from_proto<TileRow>("tiles", message.tiles()));
  for (const TileRow& row : summary.tiles)
    RETURN_IF_ERROR(check_range("tiles.mix", row.mix, 0, static_cast<int>(summary.mixes.size()) - 1));
  ASSIGN_OR_RETURN(summary.workers, list_from_proto<WorkerInfo>("workers", message.workers()));
  ASSIGN_OR_RETURN(summary.load, from_proto(message.load()));
  for (const double amount : {message.worker_cpu_seconds(), message.render_wall_seconds(),
                              message.total_wall_seconds(), message.first_result_seconds()})
    RETURN_IF_ERROR(check_amount("summary", amount));
  summary.worker_cpu_seconds = message.worker_cpu_seconds();
  summary.render_wall_seconds = message.render_wall_seconds();
  summary.total_wall_seconds = message.total_wall_seconds();
  summary.first_result_seconds = message.first_result_seconds();
  return summary;
}

}  // namespace penumbra

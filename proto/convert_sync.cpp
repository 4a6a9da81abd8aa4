// The two halves of a Sync.
#include "proto/blob_folder.h"
#include "proto/convert.h"
#include "proto/convert_check.h"

namespace penumbra {

v1::LeaseId to_proto(const LeaseId& lease) {
  v1::LeaseId out;
  out.set_job(lease.job);
  out.set_task(lease.task);
  out.set_epoch(lease.epoch);
  return out;
}

absl::StatusOr<LeaseId> from_proto(const v1::LeaseId& message) {
  RETURN_IF_ERROR(check_text("lease.job", message.job()));
  return LeaseId{message.job(), message.task(), message.epoch()};
}

static v1::SyncRequest::Failed::Reason to_proto(TaskFailure reason) {
  switch (reason) {
    case TaskFailure::kBadInput:
      return v1::SyncRequest::Failed::REASON_BAD_INPUT;
    case TaskFailure::kError:
      return v1::SyncRequest::Failed::REASON_ERROR;
    case TaskFailure::kReturned:
      return v1::SyncRequest::Failed::REASON_RETURNED;
    case TaskFailure::kLostInput:
      return v1::SyncRequest::Failed::REASON_LOST_INPUT;
  }
  std::abort();
}

static absl::StatusOr<TaskFailure> from_proto(v1::SyncRequest::Failed::Reason reason) {
  switch (reason) {
    case v1::SyncRequest::Failed::REASON_BAD_INPUT:
      return TaskFailure::kBadInput;
    case v1::SyncRequest::Failed::REASON_ERROR:
      return TaskFailure::kError;
    case v1::SyncRequest::Failed::REASON_RETURNED:
      return TaskFailure::kReturned;
    case v1::SyncRequest::Failed::REASON_LOST_INPUT:
      return TaskFailure::kLostInput;
    default:
      return invalid_input("failed.reason: unknown value {}", static_cast<int>(reason));
  }
}

absl::StatusOr<HeldLease> from_proto(const v1::SyncRequest::Held& message) {
  ASSIGN_OR_RETURN(LeaseId lease, from_proto(message.lease()));
  return HeldLease{std::move(lease), message.begun()};
}

absl::StatusOr<CompletedTask> from_proto(const v1::SyncRequest::Completed& message) {
  CompletedTask task;
  ASSIGN_OR_RETURN(task.lease, from_proto(message.lease()));
  if (!message.result().empty() && !is_digest(message.result()))
    return invalid_input("completed.result: '{:.80}' is not a digest", message.result());
  task.result = message.result();
  if (message.bytes().size() > kMostBytesAlong)
    return invalid_input("completed.bytes: {} bytes, at most {} may come with a report",
                         message.bytes().size(), kMostBytesAlong);
  if (message.result().empty() && !message.bytes().empty())
    return invalid_input("completed.bytes: bytes without a digest");
  task.bytes = message.bytes();
  ASSIGN_OR_RETURN(task.costs, list_from_proto<MixCost>("completed.costs", message.costs()));
  RETURN_IF_ERROR(check_text("completed.log", message.log()));
  task.log = message.log();
  return task;
}

absl::StatusOr<FailedTask> from_proto(const v1::SyncRequest::Failed& message) {
  FailedTask task;
  ASSIGN_OR_RETURN(task.lease, from_proto(message.lease()));
  ASSIGN_OR_RETURN(task.reason, from_proto(message.reason()));
  RETURN_IF_ERROR(check_text("failed.message", message.message()));
  task.message = message.message();
  RETURN_IF_ERROR(check_text("failed.log", message.log()));
  task.log = message.log();
  return task;
}

absl::StatusOr<LoadedScene> from_proto(const v1::SyncRequest::Loaded& message) {
  LoadedScene scene;
  RETURN_IF_ERROR(check_text("loaded.job", message.job()));
  scene.job = message.job();
  ASSIGN_OR_RETURN(scene.report, from_proto(message.report()));
  for (const v1::SyncRequest::Loaded::Substitution& substitution : message.substitutions()) {
    RETURN_IF_ERROR(check_text("loaded.substitutions", substitution.text()));
    scene.substitutions.push_back({substitution.mix(), substitution.text()});
  }
  return scene;
}

static void add_reports(const WorkerState& state, v1::SyncRequest& out) {
  for (const HeldLease& held : state.held) {
    v1::SyncRequest::Held* added = out.add_held();
    *added->mutable_lease() = to_proto(held.lease);
    added->set_begun(held.begun);
  }
  for (const CompletedTask& task : state.completed) {
    v1::SyncRequest::Completed* added = out.add_completed();
    *added->mutable_lease() = to_proto(task.lease);
    added->set_result(task.result);
    added->set_bytes(task.bytes);
    for (const MixCost& cost : task.costs) *added->add_costs() = to_proto(cost);
    added->set_log(task.log);
  }
  for (const FailedTask& task : state.failed) {
    v1::SyncRequest::Failed* added = out.add_failed();
    *added->mutable_lease() = to_proto(task.lease);
    added->set_reason(to_proto(task.reason));
    added->set_message(task.message);
    added->set_log(task.log);
  }
  for (const LoadedScene& scene : state.loaded) *out.add_loaded() = to_proto(scene);
}

v1::SyncRequest::Loaded to_proto(const LoadedScene& scene) {
  v1::SyncRequest::Loaded out;
  out.set_job(scene.job);
  *out.mutable_report() = to_proto(scene.report);
  for (const Substitution& substitution : scene.substitutions) {
    v1::SyncRequest::Loaded::Substitution* added = out.add_substitutions();
    added->set_mix(substitution.mix);
    added->set_text(substitution.text);
  }
  return out;
}

v1::SyncRequest to_proto(const WorkerState& state) {
  v1::SyncRequest out;
  out.set_protocol(kSyncProtocol);
  out.set_version(state.version);
  *out.mutable_worker() = to_proto(state.worker);
  out.set_name(state.name);
  add_reports(state, out);
  out.set_wanted(state.wanted);
  for (const JobId& job : state.known_jobs) out.add_known_jobs(job);
  out.set_process_cpu_seconds(state.process_cpu_seconds);
  out.set_wait_milliseconds(state.wait_milliseconds);
  out.set_draining(state.draining);
  return out;
}

absl::StatusOr<WorkerState> from_proto(const v1::SyncRequest& message) {
  if (message.protocol() != kSyncProtocol)
    return make_status(absl::StatusCode::kFailedPrecondition,
                       "the worker ({}) speaks protocol {}, the server ({}) speaks {}", message.version(),
                       message.protocol(), PENUMBRA_VERSION, kSyncProtocol);
  WorkerState state;
  RETURN_IF_ERROR(check_text("version", message.version()));
  RETURN_IF_ERROR(check_text("name", message.name(), kMostPath));
  if (message.name().empty()) return invalid_input("name: empty");
  state.version = message.version();
  state.name = message.name();
  ASSIGN_OR_RETURN(state.worker, from_proto(message.worker()));
  ASSIGN_OR_RETURN(state.held, list_from_proto<HeldLease>("held", message.held()));
  ASSIGN_OR_RETURN(state.completed, list_from_proto<CompletedTask>("completed", message.completed()));
  ASSIGN_OR_RETURN(state.failed, list_from_proto<FailedTask>("failed", message.failed()));
  ASSIGN_OR_RETURN(state.loaded, list_from_proto<LoadedScene>("loaded", message.loaded()));
  state.wanted = message.wanted();
  ASSIGN_OR_RETURN(state.known_jobs, texts_from_proto("known_jobs", message.known_jobs()));
  RETURN_IF_ERROR(check_reported("process_cpu_seconds", message.process_cpu_seconds()));
  state.process_cpu_seconds = message.process_cpu_seconds();
  state.wait_milliseconds = message.wait_milliseconds();
  state.draining = message.draining();
  return state;
}

v1::SyncResponse to_proto(const DesiredState& state) {
  v1::SyncResponse out;
  for (const DesiredLease& lease : state.leases) {
    v1::SyncResponse::Lease* added = out.add_leases();
    *added->mutable_lease() = to_proto(lease.lease);
    if (lease.task) *added->mutable_task() = to_proto(*lease.task);
  }
  for (const JobDescription& job : state.jobs) {
    v1::SyncResponse::JobDescription* added = out.add_jobs();
    added->set_job(job.job);
    *added->mutable_spec() = to_proto(job.spec);
  }
  for (const LeaseId& lease : state.acknowledged) *out.add_acknowledged() = to_proto(lease);
  for (const JobId& job : state.acknowledged_loads) out.add_acknowledged_loads(job);
  for (const JobId& job : state.finished_jobs) out.add_finished_jobs(job);
  out.set_next_sync_milliseconds(state.next_sync_milliseconds);
  return out;
}

absl::StatusOr<DesiredState> from_proto(const v1::SyncResponse& message) {
  DesiredState state;
  for (const v1::SyncResponse::Lease& lease : message.leases()) {
    DesiredLease desired;
    ASSIGN_OR_RETURN(desired.lease, from_proto(lease.lease()));
    if (lease.has_task()) {
      ASSIGN_OR_RETURN(desired.task, from_proto(lease.task()));
    }
    state.leases.push_back(std::move(desired));
  }
  for (const v1::SyncResponse::JobDescription& job : message.jobs()) {
    ASSIGN_OR_RETURN(JobSpec spec, from_proto(job.spec()));
    state.jobs.push_back({job.job(), std::move(spec)});
  }
  ASSIGN_OR_RETURN(state.acknowledged, list_from_proto<LeaseId>("acknowledged", message.acknowledged()));
  ASSIGN_OR_RETURN(state.acknowledged_loads,
                   texts_from_proto("acknowledged_loads", message.acknowledged_loads()));
  ASSIGN_OR_RETURN(state.finished_jobs, texts_from_proto("finished_jobs", message.finished_jobs()));
  state.next_sync_milliseconds = message.next_sync_milliseconds();
  return state;
}

}  // namespace penumbra

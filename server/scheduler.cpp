#include "server/scheduler.h"

#include <algorithm>
#include <set>

#include "proto/status.h"

namespace penumbra {
namespace {

/// Whether the result is what the task asked for.
absl::Status check_result(const TileTask& task, const CompletedTask& done,
                          const absl::StatusOr<ResultShape>& shape) {
  if (done.costs.size() != costs_of(task))
    return invalid_input("{} costs, where the task has {}", done.costs.size(), costs_of(task));
  if (task.kind == TaskKind::kPilot) return absl::OkStatus();
  if (!shape.ok()) return shape.status();
  if (shape->rect != task.tile) return invalid_input("the result covers another tile");
  if (shape->passes.size() != task.passes.size())
    return invalid_input("{} results for {} mixes", shape->passes.size(), task.passes.size());
  for (size_t m = 0; m < task.passes.size(); ++m)
    if (shape->passes[m] != task.passes[m].count())
      return invalid_input("{} passes of mix {}, not {}", shape->passes[m], m, task.passes[m].count());
  return absl::OkStatus();
}

}  // namespace

void Scheduler::put(Change change) {
  changes_.push_back(std::move(change));
  ++revision_;
}

std::vector<Change> Scheduler::take_changes() {
  return std::exchange(changes_, {});
}

const JobRecord* Scheduler::find(const JobId& id) const {
  const auto it = jobs_.find(id);
  return it == jobs_.end() ? nullptr : it->second.get();
}

JobRecord* Scheduler::find_job(const JobId& id) {
  return const_cast<JobRecord*>(find(id));
}

uint64_t Scheduler::pending() const {
  uint64_t sum = 0;
  for (const JobId& id : order_) sum += find(id)->pending();
  return sum;
}

int Scheduler::cores() const {
  int sum = 0;
  for (const auto& [id, worker] : workers_)
    if (!worker.draining) sum += worker.info.cores;
  return sum;
}

absl::Status Scheduler::restore(const StoredState& stored, const Now& now) {
  for (const WorkerInfo& worker : stored.workers) contributors_[worker.id] = worker;
  for (const StoredJob& kept : stored.jobs) {
    auto job = std::make_unique<JobRecord>(kept.header);
    RETURN_IF_ERROR(job->restore(kept));
    job->scheduler_cpu_base = now.process_cpu;
    for (const StoredJob::Lease& lease : kept.leases) {
      const TaskRecord& task = *job->task(lease.lease.task);
      if (task.state != TaskState::kLeased) continue;
      WorkerRecord& worker = workers_[lease.holder.worker];
      worker.info.id = lease.holder.worker;
      worker.info.host = lease.holder.host;
      worker.name = lease.holder.name;
      worker.last_seen = now.steady;
      worker.leases[{kept.header.id, lease.lease.task}] = lease.lease.epoch;
      incarnations_[{lease.holder.host, lease.holder.name}] = lease.holder.worker;
    }
    requests_[kept.header.request_id] = kept.header.id;
    JobRecord& record = *(jobs_[kept.header.id] = std::move(job));
    if (record.final()) continue;
    order_.push_back(kept.header.id);
    advance(record, now);
  }
  return absl::OkStatus();
}

JobId Scheduler::submit(const JobId& id, const std::string& request_id, const JobSpec& spec, const Now& now) {
  if (const auto it = requests_.find(request_id); it != requests_.end()) return it->second;
  PENUMBRA_CHECK(!jobs_.contains(id));
  JobHeader header;
  header.id = id;
  header.request_id = request_id;
  header.spec = spec;
  header.submitted_unix = now.unix_time;
  auto job = std::make_unique<JobRecord>(std::move(header));
  job->scheduler_cpu_base = now.process_cpu;
  requests_[request_id] = id;
  order_.push_back(id);
  JobRecord& record = *(jobs_[id] = std::move(job));
  put(PutJob{record.header});
  advance(record, now);
  return id;
}

absl::Status Scheduler::cancel(const JobId& id, const Now& now) {
  JobRecord* job = find_job(id);
  if (job == nullptr) return make_status(absl::StatusCode::kNotFound, "no job {}", id);
  if (!job->final()) finish(*job, JobState::kCancelled, FailureKind::kNone, "cancelled", now);
  return absl::OkStatus();
}

void Scheduler::finish(JobRecord& job, JobState state, FailureKind failure, std::string message,
                       const Now& now) {
  for (auto& [id, worker] : workers_) {
    for (auto it = worker.leases.begin(); it != worker.leases.end();) {
      if (it->first.first != job.header.id) {
        ++it;
        continue;
      }
      job.release(it->first.second);
      it = worker.leases.erase(it);
    }
  }
  job.header.state = state;
  job.header.failure = failure;
  job.header.message = std::move(message);
  job.header.finished_unix = now.unix_time;
  job.header.scheduler_cpu_seconds += now.process_cpu - job.scheduler_cpu_base;
  job.scheduler_cpu_base = now.process_cpu;
  std::erase(order_, job.header.id);
  put(PutJob{job.header});
}

/// Plans when the pilot is done, ends the job when everything is.
void Scheduler::advance(JobRecord& job, const Now& now) {
  if (job.ready_to_plan()) {
    const absl::Status status = job.make_run();
    if (!status.ok()) {
      finish(job, JobState::kFailed, FailureKind::kJobFailed, message_of(status), now);
      return;
    }
    put(PutJob{job.header});
  }
  if (job.all_done()) finish(job, JobState::kDone, FailureKind::kNone, "", now);
}

std::optional<double> Scheduler::next_expiry() const {
  std::optional<double> next;
  for (const auto& [id, worker] : workers_)
    next = std::min(next.value_or(worker.last_seen), worker.last_seen);
  if (next) *next += limits_.silence_seconds;
  return next;
}

void Scheduler::expire(const Now& now) {
  std::vector<std::string> silent;
  for (const auto& [id, worker] : workers_)
    if (now.steady - worker.last_seen >= limits_.silence_seconds) silent.push_back(id);
  for (const std::string& id : silent) end_worker(id, now);
  std::erase_if(retired_,
                [&](const auto& entry) { return now.steady - entry.second >= limits_.retired_seconds; });
}

void Scheduler::end_lease(WorkerRecord& worker, JobRecord& job, uint64_t task) {
  put(DropLease{{job.header.id, task, job.task(task)->epoch}});
  job.release(task);
  worker.leases.erase({job.header.id, task});
}

void Scheduler::end_worker(const std::string& id, const Now& now) {
  const auto it = workers_.find(id);
  WorkerRecord& worker = it->second;
  while (!worker.leases.empty()) {
    const auto [job_id, task] = worker.leases.begin()->first;
    JobRecord& job = *find_job(job_id);
    const bool begun = job.task(task)->begun;
    end_lease(worker, job, task);
    if (!begun) continue;
    Blame& blame = job.blames[task];
    blame.deaths.insert(id);
    if (blame.deaths.size() >= limits_.deaths)
      finish(job, JobState::kFailed, FailureKind::kJobFailed,
             fmt::format("task {}: {} workers died while they rendered it; the last was {} on {}", task,
                         blame.deaths.size(), worker.name, worker.info.host),
             now);
  }
  const Identity identity{worker.info.host, worker.name};
  if (const auto latest = incarnations_.find(identity); latest != incarnations_.end() && latest->second == id)
    incarnations_.erase(latest);
  workers_.erase(it);
  ++revision_;
}

absl::StatusOr<WorkerRecord*> Scheduler::meet(const WorkerState& state, const Now& now) {
  const std::string& id = state.worker.id;
  if (retired_.contains(id))
    return make_status(absl::StatusCode::kFailedPrecondition,
                       "a newer incarnation of worker {} on {} is at work", state.name, state.worker.host);
  const Identity identity{state.worker.host, state.name};
  if (const auto it = incarnations_.find(identity); it != incarnations_.end() && it->second != id) {
    const std::string old = it->second;
    end_worker(old, now);
    retired_[old] = now.steady;
  }
  incarnations_[identity] = id;
  const bool known = workers_.contains(id);
  WorkerRecord& worker = workers_[id];
  if (!known) ++revision_;
  if (worker.draining != state.draining) ++revision_;
  worker.info = state.worker;
  worker.name = state.name;
  worker.version = state.version;
  worker.last_seen = now.steady;
  worker.draining = state.draining;
  return &worker;
}

absl::Status Scheduler::report(const WorkerState& state,
                               const std::vector<absl::StatusOr<ResultShape>>& shapes, const Now& now) {
  PENUMBRA_CHECK(shapes.size() == state.completed.size());
  ASSIGN_OR_RETURN(WorkerRecord * met, meet(state, now));
  WorkerRecord& worker = *met;
  // The process's CPU time goes to the job that it works for, once that renders: against cores × wall time
  // of the render phase it says how busy the cores were. A worker rarely holds two jobs' leases.
  const double spent = std::max(0.0, state.process_cpu_seconds - worker.process_cpu_seconds);
  if (!worker.leases.empty()) {
    JobHeader& header = find_job(worker.leases.begin()->first.first)->header;
    if (header.first_lease_unix != 0) header.worker_cpu_seconds += spent;
  }
  worker.process_cpu_seconds = state.process_cpu_seconds;
  for (const HeldLease& held : state.held) {
    JobRecord* job = find_job(held.lease.job);
    const auto mine = worker.leases.find({held.lease.job, held.lease.task});
    if (held.begun && mine != worker.leases.end() && mine->second == held.lease.epoch)
      job->mark_begun(held.lease.task);
  }
  for (const LoadedScene& scene : state.loaded) take_load(scene);
  for (size_t i = 0; i < state.completed.size(); ++i) complete(worker, state.completed[i], shapes[i], now);
  for (const FailedTask& task : state.failed) fail(worker, task, now);
  return absl::OkStatus();
}

void Scheduler::complete(WorkerRecord& worker, const CompletedTask& done,
                         const absl::StatusOr<ResultShape>& shape, const Now& now) {
  const auto mine = worker.leases.find({done.lease.job, done.lease.task});
  if (mine == worker.leases.end() || mine->second != done.lease.epoch) return;  // fenced
  JobRecord& job = *find_job(done.lease.job);
  const TileTask task = job.description(done.lease.task);
  const absl::Status status = check_result(task, done, shape);
  if (absl::IsNotFound(status)) return;  // not acknowledged: it will be uploaded again
  if (!status.ok()) {
    end_lease(worker, job, done.lease.task);
    blame_failure(job, done.lease.task, worker, message_of(status), now);
    return;
  }
  if (!std::exchange(worker.contributed, true)) {
    contributors_[worker.info.id] = worker.info;
    put(PutWorker{worker.info});
  }
  worker.leases.erase(mine);
  job.accept(done.lease.task, {done.result, done.costs, worker.info.id});
  put(PutResult{done.lease, done.result, done.costs, worker.info.id});
  if (task.kind == TaskKind::kRun) {
    if (job.header.first_result_unix == 0) job.header.first_result_unix = now.unix_time;
    job.header.last_result_unix = now.unix_time;
  }
  advance(job, now);
}

void Scheduler::fail(WorkerRecord& worker, const FailedTask& failed, const Now& now) {
  const auto mine = worker.leases.find({failed.lease.job, failed.lease.task});
  if (mine == worker.leases.end() || mine->second != failed.lease.epoch) return;
  JobRecord& job = *find_job(failed.lease.job);
  end_lease(worker, job, failed.lease.task);
  switch (failed.reason) {
    case TaskFailure::kReturned:
      return;
    case TaskFailure::kBadInput:
      finish(job, JobState::kFailed, FailureKind::kBadInput, failed.message, now);
      return;
    case TaskFailure::kError:
      blame_failure(job, failed.lease.task, worker, failed.message, now);
      return;
  }
}

void Scheduler::blame_failure(JobRecord& job, uint64_t task, const WorkerRecord& worker,
                              const std::string& message, const Now& now) {
  Blame& blame = job.blames[task];
  blame.reporters.insert(worker.info.id);
  ++blame.reports;
  if (blame.reporters.size() < limits_.failing_workers && blame.reports < limits_.failures) return;
  finish(job, JobState::kFailed, FailureKind::kJobFailed,
         fmt::format("task {} failed {} times on {} workers; the last was {} on {}: {}", task, blame.reports,
                     blame.reporters.size(), worker.name, worker.info.host, message),
         now);
}

void Scheduler::take_load(const LoadedScene& scene) {
  JobRecord* job = find_job(scene.job);
  if (job == nullptr || job->header.loaded) return;  // the first is as good as any
  job->header.loaded = true;
  job->header.load = scene.report;
  job->header.substitutions = scene.substitutions;
  std::erase_if(job->header.substitutions, [&](const Substitution& s) {
    return s.mix < 0 || s.mix >= static_cast<int>(job->spec().mixes.size());
  });
  put(PutJob{job->header});
}

void Scheduler::grant(WorkerRecord& worker, uint32_t wanted, const Now& now) {
  // Towards the end nobody hoards: what is left is shared by the cores.
  if (pending() < static_cast<uint64_t>(cores()))
    wanted = std::min(wanted, static_cast<uint32_t>(worker.info.cores));
  const LeaseHolder holder{worker.info.id, worker.info.host, worker.name};
  for (const JobId& id : order_) {
    JobRecord& job = *find_job(id);
    while (worker.leases.size() < wanted && job.pending() > 0) {
      const LeaseId lease = job.lease(worker.info.id);
      worker.leases[{id, lease.task}] = lease.epoch;
      const JobState state = job.is_pilot(lease.task) ? JobState::kPilot : JobState::kRunning;
      const bool first_of_run = state == JobState::kRunning && job.header.first_lease_unix == 0;
      if (first_of_run) job.header.first_lease_unix = now.unix_time;
      if (std::exchange(job.header.state, state) != state || first_of_run) put(PutJob{job.header});
      put(PutLease{lease, holder});
    }
  }
}

SyncAnswer Scheduler::answer(const WorkerState& state, const Now& now) {
  SyncAnswer out;
  const auto found = workers_.find(state.worker.id);
  if (found == workers_.end()) return out;  // ended while it waited: its next report begins anew
  WorkerRecord& worker = found->second;
  if (!state.draining) grant(worker, state.wanted, now);

  std::set<LeaseId> listed;
  for (const HeldLease& held : state.held) {
    listed.insert(held.lease);
    const auto mine = worker.leases.find({held.lease.job, held.lease.task});
    if (mine == worker.leases.end() || mine->second != held.lease.epoch) out.urgent = true;  // drop it
  }
  for (const CompletedTask& task : state.completed) {
    listed.insert(task.lease);
    // Still mine after report(): its blob is missing, and the worker must say it again.
    const auto mine = worker.leases.find({task.lease.job, task.lease.task});
    if (mine != worker.leases.end() && mine->second == task.lease.epoch) continue;
    out.desired.acknowledged.push_back(task.lease);
  }
  for (const FailedTask& task : state.failed) out.desired.acknowledged.push_back(task.lease);
  for (const LoadedScene& scene : state.loaded) out.desired.acknowledged_loads.push_back(scene.job);

  std::set<JobId> described(state.known_jobs.begin(), state.known_jobs.end());
  for (const auto& [key, epoch] : worker.leases) {
    const JobRecord& job = *find(key.first);
    DesiredLease desired{{key.first, key.second, epoch}, std::nullopt};
    if (!listed.contains(desired.lease)) {
      desired.task = job.description(key.second);
      out.urgent = true;
    }
    out.desired.leases.push_back(std::move(desired));
    if (described.insert(key.first).second) out.desired.jobs.push_back({key.first, job.spec()});
  }
  for (const JobId& id : state.known_jobs) {
    const JobRecord* job = find(id);
    if (job == nullptr || job->final()) out.desired.finished_jobs.push_back(id);
  }
  out.urgent |= !out.desired.acknowledged.empty() || !out.desired.acknowledged_loads.empty() ||
                !out.desired.finished_jobs.empty();
  return out;
}

}  // namespace penumbra

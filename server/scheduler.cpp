#include "server/scheduler.h"

#include <algorithm>
#include <set>

#include "proto/blocks.h"
#include "proto/status.h"
#include "proto/wire_text.h"

namespace penumbra {
namespace {

/// Whether the blocks of a mix's pixels have had the passes that the task gives each.
absl::Status check_blocks(const TileTask& task, size_t mix, const ResultShape& shape) {
  const auto found = std::find_if(task.chosen.begin(), task.chosen.end(),
                                  [mix](const ChosenMix& c) { return c.mix == static_cast<int>(mix); });
  const std::vector<uint8_t> alike;
  const std::vector<uint8_t>& shares = found != task.chosen.end() ? found->shares : alike;
  const std::vector<int32_t> whole;
  const std::vector<int32_t>& done = shape.block_passes.empty() ? whole : shape.block_passes[mix];
  if (shares.empty() && done.empty()) return absl::OkStatus();
  const PassRange& range = task.passes[mix];
  for (size_t b = 0; b < block_count(task.tile); ++b) {
    const int64_t asked = shares.empty() ? range.count()
                                         : passes_of_block(range.end, shares[b], found->group) -
                                               passes_of_block(range.begin, shares[b], found->group);
    const int64_t had = done.empty() ? range.count() : done[b];
    if (had != asked) return invalid_input("{} passes of block {} of mix {}, not {}", had, b, mix, asked);
  }
  return absl::OkStatus();
}

/// Whether the result is what the task asked for.
absl::Status check_result(const JobSpec& spec, const TileTask& task, const CompletedTask& done,
                          const absl::StatusOr<ResultShape>& shape) {
  if (done.costs.size() != costs_of(task))
    return invalid_input("{} costs, where the task has {}", done.costs.size(), costs_of(task));
  if (task.kind == TaskKind::kPilot) {
    if (!done.result.empty()) return invalid_input("a result, where a pilot has none");
    return absl::OkStatus();
  }
  if (!shape.ok()) return shape.status();
  if (shape->rect != task.tile) return invalid_input("the result covers another tile");
  if (shape->passes.size() != task.passes.size())
    return invalid_input("{} results for {} mixes", shape->passes.size(), task.passes.size());
  for (size_t m = 0; m < task.passes.size(); ++m)
    if (shape->passes[m] != task.passes[m].count())
      return invalid_input("{} passes of mix {}, not {}", shape->passes[m], m, task.passes[m].count());
  for (size_t m = 0; m < task.passes.size(); ++m) RETURN_IF_ERROR(check_blocks(task, m, *shape));
  const int bins = spec.transient ? spec.transient->bins : 0;
  if (std::any_of(shape->bins.begin(), shape->bins.end(), [bins](int n) { return n != bins; }))
    return invalid_input("the result has not the job's {} bins", bins);
  return absl::OkStatus();
}

}  // namespace

void Scheduler::put(Change change) {
  changes_.push_back(std::move(change));
  ++revision_;
}

std::vector<Change> Scheduler::take_changes() {
  for (const JobId& id : std::exchange(touched_, {}))
    if (const JobRecord* job = find(id)) changes_.push_back(PutJob{job->header});
  return std::exchange(changes_, {});
}

/// Into the job's log, and to the operator.
void Scheduler::note(JobRecord& job, std::optional<uint64_t> task, const std::string& worker,
                     const std::string& text, const Now& now) {
  job.append_log({now.unix_time, task, worker, text});
  notices_.push_back({about(job, task, worker), text});
}

About Scheduler::about(const JobRecord& job, std::optional<uint64_t> task, const std::string& worker) const {
  About out{job.header.id, task, std::nullopt, worker};
  if (task) out.tile = job.tile_of(*task);
  return out;
}

void Scheduler::keep_log(const LeaseId& lease, const WorkerRecord& worker, const std::string& text,
                         const Now& now) {
  constexpr size_t kMostBytes = 4096;
  if (text.empty()) return;
  put(PutLog{lease, worker.identity(), now.unix_time,
             text.substr(text.size() - std::min(text.size(), kMostBytes))});
}

/// The job's counters, to be stored with whatever is stored next.
FaultCounts& Scheduler::count_fault(JobRecord& job) {
  touched_.insert(job.header.id);
  return job.header.faults;
}

const JobRecord* Scheduler::find(const JobId& id) const {
  const auto it = jobs_.find(id);
  return it == jobs_.end() ? nullptr : it->second.get();
}

JobRecord* Scheduler::find_job(const JobId& id) {
  return const_cast<JobRecord*>(find(id));
}

absl::Status Scheduler::restore(const StoredState& stored, const Now& now) {
  for (const WorkerInfo& worker : stored.workers) contributors_[worker.id] = worker;
  const auto note_unreadable = [&](const JobId& id, const std::string& why) {
    notices_.push_back({About{id, {}, {}, {}}, "stays in the store and is not served: " + why});
  };
  for (const auto& [id, why] : stored.unreadable) note_unreadable(id, why);
  for (const StoredJob& kept : stored.jobs) {
    auto job = std::make_unique<JobRecord>(kept.header);
    // One job that is not understood must not keep the others from being served.
    if (const absl::Status restored = job->restore(kept, now); !restored.ok()) {
      note_unreadable(kept.header.id, message_of(restored));
      continue;
    }
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
    order_.push_back(&record);
    advance(record, now);
  }
  return absl::OkStatus();
}

JobId Scheduler::submit(const JobId& id, const std::string& request_id, const JobSpec& spec, const Now& now,
                        const JobTerms& terms) {
  if (const auto it = requests_.find(request_id); it != requests_.end()) return it->second;
  PENUMBRA_CHECK(!jobs_.contains(id));
  JobHeader header;
  header.id = id;
  header.request_id = request_id;
  header.spec = spec;
  header.terms = terms;
  header.submitted_unix = now.unix_time;
  auto job = std::make_unique<JobRecord>(std::move(header));
  job->scheduler_cpu_base = now.process_cpu;
  requests_[request_id] = id;
  JobRecord& record = *(jobs_[id] = std::move(job));
  order_.push_back(&record);
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
      put(DropLease{{job.header.id, it->first.second, it->second}});
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
  std::erase(order_, &job);
  put(PutJob{job.header});
  note(job, std::nullopt, "",
       fmt::format("{}{}{}", name_of(state), job.header.message.empty() ? "" : ": ", job.header.message),
       now);
  if (state != JobState::kDone) fail_followers(job, now);
}

void Scheduler::forget(const JobId& id) {
  const JobRecord* job = find(id);
  if (job == nullptr || !job->final()) return;
  requests_.erase(job->header.request_id);
  touched_.erase(id);
  jobs_.erase(id);
  put(DropJob{id});
  notices_.push_back({About{id, {}, {}, {}}, "forgotten"});
}

void Scheduler::lose_results(const JobId& id, const std::vector<std::pair<uint64_t, Digest>>& lost,
                             const Now& now) {
  JobRecord* job = find_job(id);
  if (job == nullptr) return;
  for (const auto& [task, digest] : lost) {
    if (task >= job->results().size() || job->is_pilot(task)) continue;
    const auto& result = job->results()[task];
    if (!result || result->result != digest) continue;
    note(*job, task, "", fmt::format("the disk has not kept its result {}", digest), now);
    job->lose(task);
    put(DropResult{{id, task, job->task(task)->epoch}});
    ++count_fault(*job).corrupt_results;
  }
  if (job->header.state != JobState::kDone || job->all_done()) return;
  job->header.state = JobState::kRunning;
  job->header.finished_unix = 0;
  job->scheduler_cpu_base = now.process_cpu;
  order_.push_back(job);
  put(PutJob{job->header});
}

/// Plans when the pilot is done, and anew at the borders of stages; ends the job when everything is.
void Scheduler::advance(JobRecord& job, const Now& now) {
  while (job.ready_to_plan() || job.ready_to_replan()) {
    const absl::Status status = job.ready_to_plan() ? job.make_run() : job.replan();
    if (!status.ok()) {
      finish(job, JobState::kFailed, FailureKind::kJobFailed, message_of(status), now);
      return;
    }
    put(PutJob{job.header});
  }
  if (job.all_done()) finish(job, JobState::kDone, FailureKind::kNone, "", now);
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
  // A message that was overtaken by a later one must not count the time between twice.
  worker.process_cpu_seconds = std::max(worker.process_cpu_seconds, state.process_cpu_seconds);
  for (const HeldLease& held : state.held) {
    JobRecord* job = find_job(held.lease.job);
    const auto mine = worker.leases.find({held.lease.job, held.lease.task});
    if (held.begun && mine != worker.leases.end() && mine->second == held.lease.epoch)
      job->mark_begun(held.lease.task, now);
  }
  for (const LoadedScene& scene : state.loaded) take_load(scene);
  for (size_t i = 0; i < state.completed.size(); ++i) complete(worker, state.completed[i], shapes[i], now);
  for (const FailedTask& task : state.failed) fail(worker, task, now);
  return absl::OkStatus();
}

void Scheduler::complete(WorkerRecord& worker, const CompletedTask& done,
                         const absl::StatusOr<ResultShape>& shape, const Now& now) {
  const auto mine = worker.leases.find({done.lease.job, done.lease.task});
  if (mine == worker.leases.end() || mine->second != done.lease.epoch) {  // fenced
    if (JobRecord* job = find_job(done.lease.job)) ++count_fault(*job).late_results;
    return;
  }
  JobRecord& job = *find_job(done.lease.job);
  const TileTask task = job.description(done.lease.task);
  const absl::Status status = check_result(job.spec(), task, done, shape);
  if (absl::IsNotFound(status)) return;  // not acknowledged: it will be uploaded again
  if (!status.ok()) {
    end_lease(worker, job, done.lease.task);
    ++count_fault(job).refused_results;
    blame_failure(job, done.lease.task, worker, message_of(status), now);
    return;
  }
  if (!std::exchange(worker.contributed, true)) {
    contributors_[worker.info.id] = worker.info;
    put(PutWorker{worker.info});
  }
  worker.leases.erase(mine);
  worker.failed_jobs.clear();
  worker.failures = 0;
  double seconds = 0;
  for (const MixCost& cost : done.costs) seconds += cost.cpu_seconds;
  const std::string said = fmt::format("done in {:.3g} CPU s", seconds);
  job.append_log({now.unix_time, done.lease.task, worker.identity(), said});
  notices_.push_back({about(job, done.lease.task, worker.identity()), said, true});
  keep_log(done.lease, worker, done.log, now);
  job.accept(done.lease.task, {done.result, done.costs, worker.info.id});
  put(PutResult{done.lease, done.result, done.costs, worker.info.id});
  if (task.kind == TaskKind::kRun) {
    if (job.header.first_result_unix == 0) job.header.first_result_unix = now.unix_time;
    job.header.last_result_unix = now.unix_time;
  }
  advance(job, now);
}

void Scheduler::fail(WorkerRecord& worker, FailedTask failed, const Now& now) {
  // What is made of it is stored and told, and must not be too long for that.
  constexpr size_t kMostMessage = 4096;
  failed.message = wire_text(failed.message, kMostMessage);
  const auto mine = worker.leases.find({failed.lease.job, failed.lease.task});
  if (mine == worker.leases.end() || mine->second != failed.lease.epoch) return;
  JobRecord& job = *find_job(failed.lease.job);
  end_lease(worker, job, failed.lease.task);
  keep_log(failed.lease, worker, failed.log, now);
  switch (failed.reason) {
    case TaskFailure::kReturned:
      ++count_fault(job).returned_leases;
      note(job, failed.lease.task, worker.identity(), "handed back: " + failed.message, now);
      return;
    case TaskFailure::kLostInput:
      finish(job, JobState::kFailed, FailureKind::kJobFailed, failed.message, now);
      return;
    case TaskFailure::kBadInput:
      finish(job, JobState::kFailed, FailureKind::kBadInput, failed.message, now);
      return;
    case TaskFailure::kError:
      ++count_fault(job).failures;
      blame_failure(job, failed.lease.task, worker, failed.message, now);
      return;
  }
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

SyncAnswer Scheduler::answer(const WorkerState& state, const Now& now) {
  SyncAnswer out;
  const auto found = workers_.find(state.worker.id);
  if (found == workers_.end()) return out;  // ended while it waited: its next report begins anew
  WorkerRecord& worker = found->second;
  std::set<LeaseId> listed;
  bool busy_in_vain = false;
  for (const HeldLease& held : state.held) {
    listed.insert(held.lease);
    const auto mine = worker.leases.find({held.lease.job, held.lease.task});
    if (mine != worker.leases.end() && mine->second == held.lease.epoch) continue;
    out.urgent = true;  // drop it
    busy_in_vain |= held.begun;
  }
  // What it wants was said before it knew that a thread of its renders what nobody waits for: it says it
  // anew.
  if (!state.draining && !busy_in_vain) grant(worker, state.wanted, now);
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

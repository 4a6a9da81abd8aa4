// The scheduler's view of workers: who is there, who has fallen silent, who cannot be relied on.
#include <algorithm>
#include <cmath>

#include "proto/status.h"
#include "server/scheduler.h"

namespace penumbra {

std::optional<double> Scheduler::next_expiry() const {
  std::optional<double> next;
  for (const auto& [id, worker] : workers_)
    next = std::min(next.value_or(worker.last_seen), worker.last_seen);
  if (next) *next += limits_.silence_seconds;
  return next;
}

void Scheduler::excuse(double seconds) {
  for (auto& [id, worker] : workers_) worker.last_seen += seconds;
}

void Scheduler::expire(const Now& now) {
  std::vector<std::string> silent;
  for (const auto& [id, worker] : workers_)
    if (now.steady - worker.last_seen >= limits_.silence_seconds) silent.push_back(id);
  for (const std::string& id : silent) {
    notices_.push_back({About{{}, {}, {}, workers_[id].identity()},
                        fmt::format("has been silent for {} s", limits_.silence_seconds)});
    end_worker(id, now);
  }
  expire_tasks(now);
  std::erase_if(retired_,
                [&](const auto& entry) { return now.steady - entry.second >= limits_.retired_seconds; });
}

/// A worker may renew its leases for ever and never come to an end. One that has not even begun is not to
/// blame for that.
void Scheduler::expire_tasks(const Now& now) {
  for (auto& [id, worker] : workers_) {
    std::vector<std::pair<JobId, uint64_t>> overdue;
    for (const auto& [key, epoch] : worker.leases)
      if (now.steady - find(key.first)->task(key.second)->since >= limits_.task_seconds)
        overdue.push_back(key);
    for (const auto& [job_id, task] : overdue) {
      if (!worker.leases.contains({job_id, task})) continue;  // its job has just failed
      JobRecord& job = *find_job(job_id);
      const bool begun = job.task(task)->begun;
      end_lease(worker, job, task);
      ++count_fault(job).overdue_leases;
      note(job, task, worker.identity(), "taken away: it took too long", now);
      if (begun)
        blame_failure(job, task, worker,
                      fmt::format("it has not come to an end in {} s", limits_.task_seconds), now);
    }
  }
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
    ++count_fault(job).lost_leases;
    note(job, task, worker.identity(), begun ? "lost while it was rendered" : "lost before it was begun",
         now);
    if (!begun) continue;
    Blame& blame = job.blames[task];
    blame.deaths.insert(id);
    put(PutBlame{job_id, task, id, true});
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
    notices_.push_back({About{{}, {}, {}, state.worker.host + "/" + state.name}, "has been started anew"});
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

void Scheduler::blame_failure(JobRecord& job, uint64_t task, WorkerRecord& worker, const std::string& message,
                              const Now& now) {
  Blame& blame = job.blames[task];
  blame.reporters.insert(worker.identity());
  put(PutBlame{job.header.id, task, worker.identity(), false});
  ++blame.reports;
  note(job, task, worker.identity(), "failed: " + message, now);
  hold_back(worker, job.header.id, message, now);
  if (blame.reporters.size() < limits_.failing_workers && blame.reports < limits_.failures) return;
  finish(job, JobState::kFailed, FailureKind::kJobFailed,
         fmt::format("task {} failed {} times on {} workers; the last was {} on {}: {}", task, blame.reports,
                     blame.reporters.size(), worker.name, worker.info.host, message),
         now);
}

/// Whether another worker could do what this one cannot.
bool Scheduler::has_help(const WorkerRecord& worker) const {
  return std::any_of(workers_.begin(), workers_.end(), [&](const auto& entry) {
    const WorkerRecord& other = entry.second;
    return &other != &worker && !other.draining && other.set_aside.empty();
  });
}

/// A worker that fails rests, longer each time, while there are others: it would take tasks faster than
/// those who render them. One that fails job after job is set aside until it is started anew.
void Scheduler::hold_back(WorkerRecord& worker, const JobId& job, const std::string& message,
                          const Now& now) {
  worker.failed_jobs.insert(job);
  ++worker.failures;
  if (!has_help(worker)) return;
  constexpr double kFirstRest = 0.25, kLongestRest = 30;
  worker.rest_until = now.steady + std::min(kLongestRest, std::ldexp(kFirstRest, worker.failures));
  if (worker.failed_jobs.size() < limits_.failed_jobs || !worker.set_aside.empty()) return;
  worker.set_aside = fmt::format("it failed tasks of {} jobs in a row; the last time: {}",
                                 worker.failed_jobs.size(), message);
  notices_.push_back({About{{}, {}, {}, worker.identity()}, "is set aside: " + worker.set_aside});
}

}  // namespace penumbra

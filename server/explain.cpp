// Why a job is (not) running: the reasons that the scheduler's own decisions follow, in the same words.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "server/job_report.h"

namespace penumbra {
namespace {

/// Why nobody could take a task now, whatever its job.
std::vector<std::string> reasons_of_workers(const Scheduler& scheduler, const Now& now) {
  std::vector<std::string> reasons;
  size_t able = 0, draining = 0;
  for (const auto& [id, worker] : scheduler.workers()) {
    draining += worker.draining;
    able += !worker.draining && worker.set_aside.empty() && now.steady >= worker.rest_until;
  }
  if (scheduler.workers().empty()) return {"No worker is connected: start penumbra-worker."};
  if (able == 0 && draining == scheduler.workers().size())
    return {fmt::format("All {} workers are draining: they finish what they have and end.", draining)};
  if (able == 0)
    reasons.push_back("No worker takes tasks now: those that are here drain, rest or are set aside.");
  for (const auto& [id, worker] : scheduler.workers()) {
    if (!worker.set_aside.empty())
      reasons.push_back(fmt::format("Worker {} on {} is set aside until it is started anew: {}.", worker.name,
                                    worker.info.host, worker.set_aside));
    else if (now.steady < worker.rest_until)
      reasons.push_back(fmt::format("Worker {} on {} has failed {} times in a row and rests for {:.0f} s.",
                                    worker.name, worker.info.host, worker.failures,
                                    worker.rest_until - now.steady));
  }
  return reasons;
}

/// Why other jobs' tasks are given out before this one's.
std::vector<std::string> reasons_of_queue(const Scheduler& scheduler, const JobRecord& job) {
  std::vector<std::string> reasons;
  const JobTerms& terms = job.header.terms;
  const std::string user = terms.user.empty() ? "(nobody)" : terms.user;
  if (const std::string* before = scheduler.waits_for(job)) {
    const JobRecord& other = *scheduler.find(*before);
    reasons.push_back(fmt::format("It waits for job {}, which is {}.", *before, name_of(other.header.state)));
  }
  const uint64_t mine = scheduler.leased_by(terms.user), quota = scheduler.quota_of(terms.user).leases;
  if (mine >= quota)
    reasons.push_back(
        fmt::format("User {} has {} tasks with workers, as many as the quota allows.", user, mine));
  if (job.pending() == 0) return reasons;
  uint64_t above = 0, earlier = 0;
  std::map<std::string, uint64_t> others;  // user -> leases
  for (const auto& [id, other] : scheduler.jobs()) {
    if (other->final() || other.get() == &job) continue;
    if (other->header.terms.user != terms.user) {
      if (other->pending() > 0) others[other->header.terms.user] += 0;
      continue;
    }
    if (other->header.terms.priority > terms.priority) above += other->pending();
    if (other->header.terms.priority == terms.priority &&
        other->header.submitted_unix < job.header.submitted_unix)
      earlier += other->pending();
  }
  if (above > 0)
    reasons.push_back(
        fmt::format("{} tasks of jobs of higher priority than {} come first.", above, terms.priority));
  if (earlier > 0) reasons.push_back(fmt::format("{} tasks of jobs submitted earlier come first.", earlier));
  for (auto& [other, leases] : others)
    if ((leases = scheduler.leased_by(other)) < mine)
      reasons.push_back(
          fmt::format("User {} is served first, with {} tasks at workers against {} of user {}.",
                      other.empty() ? "(nobody)" : other, leases, mine, user));
  return reasons;
}

std::string describe(const WorkerRecord& worker, const JobRecord& job, const Now& now) {
  const auto holds = std::count_if(worker.leases.begin(), worker.leases.end(),
                                   [&](const auto& lease) { return lease.first.first == job.header.id; });
  return fmt::format(
      "Worker {} on {} ({}, {} threads{}) holds {} of its tasks and {} of others; it called {:.1f} s ago.",
      worker.name, worker.info.host, worker.info.isa, worker.info.cores, worker.draining ? ", draining" : "",
      holds, worker.leases.size() - static_cast<size_t>(holds), now.steady - worker.last_seen);
}

}  // namespace

std::vector<std::string> explain(const Scheduler& scheduler, const JobRecord& job, const Now& now) {
  const JobStatus status = status_of(scheduler, job, now);
  if (job.final())
    return {fmt::format("The job is {}{}{}.", name_of(status.state), status.message.empty() ? "" : ": ",
                        status.message)};
  std::vector<std::string> reasons = reasons_of_queue(scheduler, job);
  for (std::string& reason : reasons_of_workers(scheduler, now)) reasons.push_back(std::move(reason));
  if (!job.plan())
    reasons.push_back(fmt::format("The pilot that turns the budget into passes has done {} of {} tiles.",
                                  status.tasks_done, status.tasks_total));
  reasons.push_back(fmt::format("{} of {} tasks are done, {} are with workers, {} are waiting.",
                                status.tasks_done, status.tasks_total, status.tasks_leased, job.pending()));
  for (const auto& [id, worker] : scheduler.workers()) reasons.push_back(describe(worker, job, now));
  for (const auto& [task, blame] : job.blames)
    reasons.push_back(fmt::format("Task {} has failed {} times; {} workers died while they rendered it.",
                                  task, blame.reports, blame.deaths.size()));
  return reasons;
}

}  // namespace penumbra

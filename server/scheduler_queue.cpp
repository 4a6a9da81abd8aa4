// Whose task is next. Users share the leases evenly whatever the number of their jobs; among one user's
// jobs the higher priority comes first, then the earlier one. A task that is being rendered is never taken
// away: shares are set right at the borders of tasks.
#include <algorithm>

#include "proto/status.h"
#include "server/scheduler.h"

namespace penumbra {

uint64_t Scheduler::pending() const {
  uint64_t sum = 0;
  for (const JobRecord* job : order_)
    if (waits_for(*job) == nullptr) sum += job->pending();
  return sum;
}

int Scheduler::cores() const {
  int sum = 0;
  for (const auto& [id, worker] : workers_)
    if (!worker.draining) sum += worker.info.cores;
  return sum;
}

const std::string* Scheduler::waits_for(const JobRecord& job) const {
  for (const JobId& id : job.header.terms.after) {
    const JobRecord* before = find(id);
    if (before != nullptr && before->header.state != JobState::kDone) return &id;
  }
  return nullptr;
}

/// Jobs that were to begin after one that has come to nothing never will.
void Scheduler::fail_followers(const JobRecord& job, const Now& now) {
  for (const std::vector<JobRecord*> order = order_; JobRecord * follower : order) {
    const auto& after = follower->header.terms.after;
    if (follower->final() || std::find(after.begin(), after.end(), job.header.id) == after.end()) continue;
    finish(
        *follower, JobState::kFailed, FailureKind::kJobFailed,
        fmt::format("job {}, which had to be done before, is {}", job.header.id, name_of(job.header.state)),
        now);
  }
}

const JobId* Scheduler::find_request(const std::string& request_id) const {
  const auto it = requests_.find(request_id);
  return it == requests_.end() ? nullptr : &it->second;
}

const UserQuota& Scheduler::quota_of(const std::string& user) const {
  static const UserQuota kNone;
  const auto it = limits_.quotas.find(user);
  return it == limits_.quotas.end() ? kNone : it->second;
}

uint64_t Scheduler::leased_by(const std::string& user) const {
  uint64_t sum = 0;
  for (const JobRecord* job : order_)
    if (job->header.terms.user == user) sum += job->leased();
  return sum;
}

absl::Status Scheduler::check_quota(const std::string& user) const {
  const uint64_t most = quota_of(user).jobs;
  const auto jobs = static_cast<uint64_t>(std::count_if(
      order_.begin(), order_.end(), [&](const JobRecord* job) { return job->header.terms.user == user; }));
  if (jobs < most) return absl::OkStatus();
  return make_status(absl::StatusCode::kResourceExhausted, "user {} has {} unfinished jobs, the quota is {}",
                     user, jobs, most);
}

JobRecord* Scheduler::next_job(const std::set<const JobRecord*>& passed_over) const {
  std::map<std::string, uint64_t> shares;  // leases per user
  for (const JobRecord* job : order_) shares[job->header.terms.user] += job->leased();
  JobRecord* best = nullptr;
  const auto rank = [&](const JobRecord& job) {
    return std::pair(shares[job.header.terms.user], -job.header.terms.priority);
  };
  for (JobRecord* job : order_) {
    if (job->pending() == 0 || passed_over.contains(job) || waits_for(*job) != nullptr) continue;
    if (shares[job->header.terms.user] >= quota_of(job->header.terms.user).leases) continue;
    if (best == nullptr) {
      best = job;
      continue;
    }
    // Of two jobs of one user the priority decides; of two users the smaller share.
    if (rank(*job) < rank(*best)) best = job;
  }
  return best;
}

void Scheduler::grant(WorkerRecord& worker, uint32_t wanted, const Now& now) {
  if (!worker.set_aside.empty() || now.steady < worker.rest_until) return;
  if (worker.leases.size() >= wanted) return;
  const uint64_t left = pending();
  if (left == 0) return;  // at a job's end thousands wait, and ask whenever a result comes
  // Towards the end nobody hoards: what is left is shared by the cores.
  if (left < static_cast<uint64_t>(cores()))
    wanted = std::min(wanted, static_cast<uint32_t>(worker.info.cores));
  // Nobody gets a task again that it has failed at, unless there is nobody else left to try.
  const auto refuses = [&](const Blame& blame) {
    return blame.reporters.contains(worker.identity()) &&
           std::any_of(workers_.begin(), workers_.end(), [&](const auto& entry) {
             const WorkerRecord& other = entry.second;
             return !other.draining && other.set_aside.empty() && !blame.reporters.contains(other.identity());
           });
  };
  std::set<const JobRecord*> passed_over;
  while (worker.leases.size() < wanted) {
    JobRecord* job = next_job(passed_over);
    if (job == nullptr) return;
    if (const std::optional<LeaseId> lease = job->lease(worker.info.id, now, refuses))
      put_lease(worker, *job, *lease, now);
    else
      passed_over.insert(job);
  }
}

void Scheduler::put_lease(WorkerRecord& worker, JobRecord& job, const LeaseId& lease, const Now& now) {
  worker.leases[{lease.job, lease.task}] = lease.epoch;
  const JobState state = job.is_pilot(lease.task) ? JobState::kPilot : JobState::kRunning;
  const bool first_of_run = state == JobState::kRunning && job.header.first_lease_unix == 0;
  if (first_of_run) job.header.first_lease_unix = now.unix_time;
  if (std::exchange(job.header.state, state) != state || first_of_run) put(PutJob{job.header});
  put(PutLease{lease, {worker.info.id, worker.info.host, worker.name}});
}

}  // namespace penumbra

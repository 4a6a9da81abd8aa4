#include "server/http_snapshot.h"

#include <algorithm>
#include <chrono>
#include <set>

#include "proto/status.h"

namespace penumbra {
namespace {

constexpr double kLongestSeconds = 1;

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

WorkerView view_of(const WorkerRecord& worker, const Now& now) {
  return {worker.info,
          worker.name,
          worker.version,
          worker.leases.size(),
          worker.draining,
          std::max(0.0, now.steady - worker.last_seen),
          worker.process_cpu_seconds,
          worker.set_aside};
}

}  // namespace

absl::StatusOr<std::shared_ptr<const Snapshot>> Snapshots::take() {
  std::set<JobId> known, present;
  for (const auto& [id, view] : final_) known.insert(id);
  // Runs on the coordinator's thread while this one waits.
  auto taken = coordinator_.call([&](Scheduler& scheduler, const Now& now) {
    auto snapshot = std::make_shared<Snapshot>();
    for (const auto& [id, job] : scheduler.jobs()) {
      present.insert(id);
      if (!known.contains(id))
        snapshot->jobs.push_back({status_of(scheduler, *job, now), labels(job->spec().mixes)});
    }
    for (const auto& [id, worker] : scheduler.workers()) snapshot->workers.push_back(view_of(worker, now));
    snapshot->taken_unix = now.unix_time;
    snapshot->server_cpu_seconds = now.process_cpu;
    return snapshot;
  });
  if (!taken.ok()) return taken.status();
  Snapshot& snapshot = **taken;
  std::erase_if(final_, [&](const auto& entry) { return !present.contains(entry.first); });
  const size_t fresh = snapshot.jobs.size();
  for (const auto& [id, view] : final_) snapshot.jobs.push_back(view);
  for (size_t i = 0; i < fresh; ++i)
    if (is_final(snapshot.jobs[i].status.state)) final_[snapshot.jobs[i].status.job] = snapshot.jobs[i];
  std::stable_sort(snapshot.jobs.begin(), snapshot.jobs.end(), [](const JobView& a, const JobView& b) {
    return a.status.submitted_unix_seconds > b.status.submitted_unix_seconds;
  });
  return *taken;
}

absl::StatusOr<std::shared_ptr<const Snapshot>> Snapshots::latest() {
  const std::lock_guard lock(mutex_);
  return current();
}

absl::StatusOr<std::shared_ptr<const JobDetail>> Snapshots::detail(const JobId& job) {
  const std::lock_guard lock(mutex_);
  ASSIGN_OR_RETURN(const std::shared_ptr<const Snapshot> snapshot, current());
  const auto missing = [&] { return make_status(absl::StatusCode::kNotFound, "no job {:.80}", job); };
  // Names that are made up do not reach the coordinator.
  if (std::none_of(snapshot->jobs.begin(), snapshot->jobs.end(),
                   [&](const JobView& view) { return view.status.job == job; }))
    return missing();
  const double now = steady_seconds();
  std::erase_if(details_, [&](const auto& entry) { return now - entry.second.taken >= kLongestSeconds; });
  if (const auto kept = details_.find(job); kept != details_.end()) return kept->second.detail;
  auto taken =
      coordinator_.call([&](Scheduler& scheduler, const Now& at) -> std::shared_ptr<const JobDetail> {
        const JobRecord* record = scheduler.find(job);
        if (record == nullptr) return nullptr;
        return std::make_shared<JobDetail>(JobDetail{
            status_of(scheduler, *record, at), mix_summaries(*record), explain(scheduler, *record, at)});
      });
  RETURN_IF_ERROR(taken.status());
  if (*taken == nullptr) return missing();
  details_[job] = {*taken, now};
  return *taken;
}

absl::StatusOr<std::shared_ptr<const Snapshot>> Snapshots::current() {
  if (coordinator_.failed()) return absl::UnavailableError("the job store failed");
  const double now = steady_seconds();
  if (latest_ && now - latest_steady_ < kLongestSeconds) return latest_;
  ASSIGN_OR_RETURN(latest_, take());
  latest_steady_ = now;
  return latest_;
}

}  // namespace penumbra

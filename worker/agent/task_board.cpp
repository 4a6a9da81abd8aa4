#include "worker/agent/task_board.h"

#include <algorithm>
#include <chrono>

namespace penumbra {
namespace {

// A Sync that reports must be over in time on a slow link, too: 8 s at 1 Mb/s.
constexpr size_t kMostBytesOfSync = size_t{1} << 20;

}  // namespace

void TaskBoard::describe(WorkerState& state) {
  const std::lock_guard lock(mutex_);
  // A cancelled task is no longer ours, even while its thread has not noticed.
  for (const auto& [lease, held] : held_)
    if (!held.assignment->cancel) state.held.push_back({lease, held.begun});
  news_ = false;
  size_t bytes_left = kMostBytesOfSync;
  for (const auto& [lease, finished] : completed_) {
    const size_t along = finished->along ? finished->bytes.size() : 0;
    if (finished->uploading || along > bytes_left) {
      state.held.push_back({lease, true});
      news_ = news_ || !finished->uploading;
      continue;
    }
    bytes_left -= along;
    state.completed.push_back(finished->report);
    if (finished->along) state.completed.back().bytes = finished->bytes;
  }
  for (const auto& [lease, failed] : failed_) state.failed.push_back(failed);
  for (const auto& [job, scene] : loads_) state.loaded.push_back(scene);
  for (const auto& [job, spec] : jobs_) state.known_jobs.push_back(job);
  state.wanted = draining_ ? 0 : wanted_ - std::min(wanted_, lost_threads());
  state.draining = draining_;
}

std::vector<std::shared_ptr<Finished>> TaskBoard::apply(const DesiredState& desired,
                                                        const WorkerState& told) {
  const std::lock_guard lock(mutex_);
  for (const JobDescription& job : desired.jobs) jobs_[job.job] = std::make_shared<const JobSpec>(job.spec);
  for (const LeaseId& lease : desired.acknowledged) {
    completed_.erase(lease);
    failed_.erase(lease);
  }
  for (const JobId& job : desired.acknowledged_loads) loads_.erase(job);

  std::set<LeaseId> wanted;
  for (const DesiredLease& lease : desired.leases) wanted.insert(lease.lease);
  // Only what the server was told of can be missing from its answer on purpose.
  for (const HeldLease& held : told.held) {
    const auto it = held_.find(held.lease);
    if (!wanted.contains(held.lease)) completed_.erase(held.lease);
    if (it == held_.end() || wanted.contains(held.lease)) continue;
    it->second.assignment->cancel = true;
    it->second.lost = true;
    if (!it->second.begun) held_.erase(it);  // the others go when their thread notices
  }
  std::vector<std::shared_ptr<Finished>> missing;
  for (const CompletedTask& task : told.completed)
    if (const auto it = completed_.find(task.lease);
        it != completed_.end() && wanted.contains(task.lease) && !it->second->uploading) {
      it->second->along = false;
      it->second->uploading = true;
      missing.push_back(it->second);
    }

  for (const DesiredLease& lease : desired.leases) {
    const auto job = jobs_.find(lease.lease.job);
    const bool known =
        held_.contains(lease.lease) || completed_.contains(lease.lease) || failed_.contains(lease.lease);
    if (!lease.task || known || closed_ || job == jobs_.end()) continue;
    auto assignment = std::make_shared<Assignment>();
    assignment->lease = lease.lease;
    assignment->task = *lease.task;
    assignment->job = job->second;
    held_[lease.lease] = {std::move(assignment)};
    if (draining_) hand_back(lease.lease, "the worker is going away");
    work_.notify_one();
  }
  for (const JobId& job : desired.finished_jobs) {
    jobs_.erase(job);
    loads_.erase(job);
    reported_loads_.erase(job);
  }
  return missing;
}

void TaskBoard::uploaded(Finished& finished) {
  const std::lock_guard lock(mutex_);
  finished.uploading = false;
  news_ = true;
  news_cv_.notify_all();
}

bool TaskBoard::wants(const LeaseId& lease) const {
  const std::lock_guard lock(mutex_);
  return completed_.contains(lease);
}

/// Leases that the threads would take which still render something that nobody wants any more. Most notice
/// within a pass; one that never does must not sit on leases for ever.
uint32_t TaskBoard::lost_threads() const {
  const auto lost =
      std::count_if(held_.begin(), held_.end(), [](const auto& held) { return held.second.lost; });
  return kLeasesPerThread * static_cast<uint32_t>(lost);
}

bool TaskBoard::full() const {
  const std::lock_guard lock(mutex_);
  const uint32_t lost = lost_threads();
  const auto held = std::count_if(held_.begin(), held_.end(), [](const auto& h) { return !h.second.lost; });
  return !draining_ && !closed_ && static_cast<uint32_t>(held) >= wanted_ - std::min(wanted_, lost);
}

bool TaskBoard::wait_for_news(double seconds) {
  return wait_for_news_or(false, seconds) == Woken::kNews;
}

TaskBoard::Woken TaskBoard::wait_for_news_or(const bool& done, double seconds) {
  std::unique_lock lock(mutex_);
  news_cv_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return news_ || done; });
  return done ? Woken::kDone : news_ ? Woken::kNews : Woken::kTime;
}

bool TaskBoard::wait_for(const bool& done, double seconds) {
  std::unique_lock lock(mutex_);
  return news_cv_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return done; });
}

void TaskBoard::set(bool& done) {
  const std::lock_guard lock(mutex_);
  done = true;
  news_cv_.notify_all();
}

std::shared_ptr<Assignment> TaskBoard::take() {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (closed_) return nullptr;
    const auto next =
        std::find_if(held_.begin(), held_.end(), [](const auto& held) { return !held.second.begun; });
    if (next != held_.end()) {
      next->second.begun = true;
      return next->second.assignment;
    }
    work_.wait(lock);
  }
}

void TaskBoard::complete(const Assignment& assignment, std::shared_ptr<Finished> finished) {
  const std::lock_guard lock(mutex_);
  held_.erase(assignment.lease);
  completed_[assignment.lease] = std::move(finished);
  news_ = true;
  news_cv_.notify_all();
}

void TaskBoard::fail(const Assignment& assignment, TaskFailure reason, std::string message, std::string log) {
  const std::lock_guard lock(mutex_);
  held_.erase(assignment.lease);
  failed_[assignment.lease] = {assignment.lease, reason, std::move(message), std::move(log)};
  news_ = true;
  news_cv_.notify_all();
}

void TaskBoard::drop(const Assignment& assignment) {
  const std::lock_guard lock(mutex_);
  if (held_.erase(assignment.lease) == 0) return;
  news_ = true;  // there is room for another
  news_cv_.notify_all();
}

void TaskBoard::loaded(const LoadedScene& scene) {
  const std::lock_guard lock(mutex_);
  if (!reported_loads_.insert(scene.job).second) return;
  loads_[scene.job] = scene;
  news_ = true;
  news_cv_.notify_all();
}

void TaskBoard::hand_back(const LeaseId& lease, std::string message) {
  held_.erase(lease);
  failed_[lease] = {lease, TaskFailure::kReturned, std::move(message), {}};
}

void TaskBoard::drain() {
  const std::lock_guard lock(mutex_);
  draining_ = true;
  std::vector<LeaseId> waiting;
  for (const auto& [lease, held] : held_)
    if (!held.begun) waiting.push_back(lease);
  for (const LeaseId& lease : waiting) hand_back(lease, "the worker is going away");
  news_ = true;
  news_cv_.notify_all();
}

void TaskBoard::abandon() {
  const std::lock_guard lock(mutex_);
  std::vector<LeaseId> rendering;
  for (const auto& [lease, held] : held_) rendering.push_back(lease);
  for (const LeaseId& lease : rendering) {
    held_[lease].assignment->cancel = true;
    hand_back(lease, "the worker went away before the tile was done");
  }
  news_ = true;
  news_cv_.notify_all();
}

bool TaskBoard::empty() const {
  const std::lock_guard lock(mutex_);
  return held_.empty() && completed_.empty() && failed_.empty();
}

void TaskBoard::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  for (auto& [lease, held] : held_) held.assignment->cancel = true;
  work_.notify_all();
  news_cv_.notify_all();
}

}  // namespace penumbra

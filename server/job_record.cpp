#include "server/job_record.h"

#include <algorithm>
#include <utility>

#include "proto/status.h"
#include "server/replanner.h"

namespace penumbra {

JobRecord::JobRecord(JobHeader h) : header(std::move(h)), tiles_(tiles_of(header.spec)) {
  if (!needs_pilot(header.spec)) return;
  first_run_id_ = tiles_.size();
  stage_total_ = tiles_.size();
  add_tasks(tiles_.size());
}

void JobRecord::add_tasks(uint64_t count) {
  const uint64_t first = tasks_.size();
  tasks_.resize(first + count);
  results_.resize(first + count);
  for (uint64_t id = first; id < tasks_.size(); ++id) queue_.insert(queue_.end(), id);
}

TileTask JobRecord::description(uint64_t id) const {
  return is_pilot(id) ? pilot_task(spec(), tiles_, id)
                      : run_task(spec(), *plan_, tiles_, first_run_id_, id - first_run_id_);
}

bool JobRecord::measured(uint64_t id) const {
  return id - first_run_id_ < plan_->measured * tiles_.size();
}

double JobRecord::work(uint64_t id) const {
  const uint64_t index = id - first_run_id_;
  const uint64_t range = index / tiles_.size();
  const uint64_t tile = index % tiles_.size();
  double passes = 0;
  for (size_t m = 0; m < spec().mixes.size(); ++m)
    passes += static_cast<double>(run_range(*plan_, range, tile, m).count());
  return passes * static_cast<double>(tiles_[tile].area());
}

double JobRecord::fraction() const {
  if (plan_) return stage_done_ == stage_total_ ? 1 : work_done_ / work_total_;
  return stage_total_ == 0 ? 0 : static_cast<double>(stage_done_) / static_cast<double>(stage_total_);
}

std::optional<LeaseId> JobRecord::lease(const std::string& holder, const Now& now,
                                        const std::function<bool(const Blame&)>& refuses) {
  auto next = queue_.begin();
  if (!blames.empty())
    next = std::find_if(queue_.begin(), queue_.end(), [&](uint64_t id) {
      const auto blame = blames.find(id);
      return blame == blames.end() || !refuses(blame->second);
    });
  if (next == queue_.end() || final()) return std::nullopt;
  const uint64_t id = *next;
  queue_.erase(next);
  TaskRecord& task = tasks_[id];
  task.state = TaskState::kLeased;
  task.begun = false;
  task.since = now.steady;
  task.holder = holder;
  if (++task.epoch > 1) ++retries_;
  ++leased_;
  return LeaseId{header.id, id, task.epoch};
}

void JobRecord::mark_begun(uint64_t id, const Now& now) {
  TaskRecord& task = tasks_[id];
  if (std::exchange(task.begun, true)) return;
  task.since = now.steady;
}

void JobRecord::release(uint64_t id) {
  TaskRecord& task = tasks_[id];
  PENUMBRA_CHECK(task.state == TaskState::kLeased);
  task.state = TaskState::kPending;
  task.begun = false;
  task.holder.clear();
  queue_.insert(id);
  --leased_;
}

void JobRecord::accept(uint64_t id, AcceptedResult result) {
  TaskRecord& task = tasks_[id];
  PENUMBRA_CHECK(task.state == TaskState::kLeased);
  task.state = TaskState::kDone;
  task.holder.clear();
  --leased_;
  results_[id] = std::move(result);
  if (plan_.has_value() != is_pilot(id)) ++stage_done_;
  if (is_pilot(id)) return;
  work_done_ += work(id);
  if (measured(id)) --unmeasured_;
}

void JobRecord::lose(uint64_t id) {
  TaskRecord& task = tasks_[id];
  PENUMBRA_CHECK(task.state == TaskState::kDone && !is_pilot(id));
  task.state = TaskState::kPending;
  task.begun = false;
  results_[id].reset();
  queue_.insert(id);
  --stage_done_;
  work_done_ -= work(id);
  if (measured(id)) ++unmeasured_;
}

std::vector<std::vector<MixCost>> JobRecord::pilot_costs() const {
  std::vector<std::vector<MixCost>> pilot;
  for (uint64_t id = 0; id < first_run_id_; ++id) pilot.push_back(results_[id]->costs);
  return pilot;
}

PlannedPasses JobRecord::planned() const {
  return {header.passes, header.auto_plans, header.earlier_plans, header.open_borders};
}

absl::Status JobRecord::make_run() {
  if (!header.passes.empty()) return set_plan(planned());
  ASSIGN_OR_RETURN(PlannedPasses planned, planned_passes(spec(), pilot_costs()));
  return set_plan(std::move(planned));
}

bool JobRecord::ready_to_replan() const {
  return plan_ && !header.open_borders.empty() && unmeasured_ == 0;
}

absl::Status JobRecord::replan() {
  PENUMBRA_CHECK(ready_to_replan());
  ASSIGN_OR_RETURN(PlannedPasses next, replanned(spec(), pilot_costs(), planned(),
                                                 [&](uint64_t i) -> const std::vector<MixCost>* {
                                                   const auto& result = results_[first_run_id_ + i];
                                                   return result ? &result->costs : nullptr;
                                                 }));
  return set_plan(std::move(next));
}

/// What is sure keeps its tasks; all others are new.
absl::Status JobRecord::set_plan(PlannedPasses planned) {
  RETURN_IF_ERROR(check_stages(spec(), planned));
  const uint64_t sure_before = plan_ ? plan_->sure : 0;
  plan_ = make_plan(spec(), planned);
  header.passes = std::move(planned.passes);
  header.auto_plans = std::move(planned.autos);
  header.earlier_plans = std::move(planned.earlier);
  header.open_borders = std::move(planned.open);
  if (sure_before == 0) stage_done_ = 0;
  stage_total_ = task_count(*plan_, tiles_);
  tasks_.resize(first_run_id_ + stage_total_);
  results_.resize(tasks_.size());
  for (uint64_t i = sure_before * tiles_.size(); i < plan_->sure * tiles_.size(); ++i)
    queue_.insert(queue_.end(), first_run_id_ + i);
  work_total_ = 0;
  for (uint64_t id = first_run_id_; id < tasks_.size(); ++id) work_total_ += work(id);
  unmeasured_ = 0;
  for (uint64_t i = 0; i < plan_->measured * tiles_.size(); ++i)
    unmeasured_ += tasks_[first_run_id_ + i].state != TaskState::kDone;
  return absl::OkStatus();
}

absl::Status JobRecord::restore(const StoredJob& stored, const Now& now) {
  const auto broken = [&](std::string_view what) {
    return make_status(absl::StatusCode::kInternal, "job {} in the store: {}", header.id, what);
  };
  const auto take = [&](uint64_t id, uint64_t epoch) {
    queue_.erase(id);
    tasks_[id].state = TaskState::kLeased;
    tasks_[id].epoch = epoch;
    tasks_[id].since = now.steady;  // when it was leased is not known any more
    retries_ += epoch - 1;
    ++leased_;
  };
  // Pilot results first: without them there is no plan, and without a plan no run task.
  for (const bool pilot : {true, false}) {
    if (!pilot && !header.passes.empty()) {
      RETURN_IF_ERROR(make_run());
    }
    for (const PutResult& result : stored.results) {
      if (is_pilot(result.lease.task) != pilot) continue;
      if (result.lease.task >= tasks_.size()) return broken("a result of a task that does not exist");
      if (tasks_[result.lease.task].state != TaskState::kPending) return broken("two results of a task");
      take(result.lease.task, result.lease.epoch);
      accept(result.lease.task, {result.result, result.costs, result.worker});
    }
  }
  for (const StoredJob::BlameCount& stored_blame : stored.blames) {
    Blame& blame = blames[stored_blame.blame.task];
    if (stored_blame.blame.death) {
      blame.deaths.insert(stored_blame.blame.who);
    } else {
      blame.reporters.insert(stored_blame.blame.who);
      blame.reports += static_cast<int>(stored_blame.count);
    }
  }
  for (const StoredJob::Lease& lease : stored.leases) {
    if (lease.lease.task >= tasks_.size()) return broken("a lease of a task that does not exist");
    if (tasks_[lease.lease.task].state == TaskState::kDone) continue;
    take(lease.lease.task, lease.lease.epoch);
    tasks_[lease.lease.task].holder = lease.holder.worker;
    if (lease.holder.worker.empty() || final()) release(lease.lease.task);
  }
  return absl::OkStatus();
}

absl::Status JobRecord::check_tile(uint64_t tile) const {
  if (tile < tiles_.size()) return absl::OkStatus();
  return invalid_input("--tile: {} is not below {}, the number of tiles", tile, tiles_.size());
}

}  // namespace penumbra

#include "server/job_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace penumbra {
namespace {

double end_of(const JobRecord& job, const Now& now) {
  return job.final() ? job.header.finished_unix : now.unix_time;
}

/// From the first lease of a run task to the last accepted result; while it runs, until now. Wall clocks
/// may be set back: never negative.
double render_seconds(const JobRecord& job, const Now& now) {
  if (job.header.first_lease_unix == 0) return 0;
  const double end = job.final() ? job.header.last_result_unix : now.unix_time;
  return std::max(0.0, end - job.header.first_lease_unix);
}

/// Calls visit(task id, result) for every accepted task of the kind, in order of ids.
template <class Visit>
void for_each_result(const JobRecord& job, TaskKind kind, Visit visit) {
  for (uint64_t id = 0; id < job.results().size(); ++id)
    if (job.results()[id] && job.is_pilot(id) == (kind == TaskKind::kPilot)) visit(id, *job.results()[id]);
}

double sum_cpu_seconds(const JobRecord& job, TaskKind kind) {
  double sum = 0;
  for_each_result(job, kind, [&](uint64_t, const AcceptedResult& result) {
    for (const MixCost& cost : result.costs) sum += cost.cpu_seconds + cost.overhead_seconds;
  });
  // Within the run, parts of the pilot are repeated.
  for_each_result(job, TaskKind::kRun, [&](uint64_t, const AcceptedResult& result) {
    for (const MixCost& cost : result.costs) sum += kind == TaskKind::kPilot ? cost.repilot_seconds : 0;
  });
  return sum;
}

/// Ranges that every tile has finished.
size_t whole_ranges(const JobRecord& job) {
  const size_t tiles = job.tiles().size();
  size_t range = 0;
  for (uint64_t id = job.first_run_id(); id + tiles <= job.results().size(); id += tiles, ++range)
    for (size_t t = 0; t < tiles; ++t)
      if (!job.results()[id + t]) return range;
  return range;
}

/// Of fixed mixes apart; of `auto` the pilot is part of its own cost: what it buys is the plan.
void add_pilot(const JobRecord& job, std::vector<MixSummary>& mixes) {
  for_each_result(job, TaskKind::kPilot, [&](uint64_t id, const AcceptedResult& result) {
    const TileTask task = job.description(id);
    for (size_t i = 0; i < result.costs.size(); ++i) {
      const size_t m = i < mixes.size() ? i : static_cast<size_t>(task.chosen[i - mixes.size()].mix);
      mixes[m].pilot_cpu_seconds += result.costs[i].cpu_seconds + result.costs[i].overhead_seconds;
      mixes[m].non_finite += i < mixes.size() ? 0 : result.costs[i].non_finite;
    }
  });
  for (MixSummary& mix : mixes)
    if (mix.mix.automatic) mix.cpu_seconds = mix.pilot_cpu_seconds;
}

std::vector<TileRow> tile_rows(const JobRecord& job) {
  std::map<std::tuple<size_t, size_t, std::string>, TileRow> rows;  // (tile, mix, worker)
  for_each_result(job, TaskKind::kRun, [&](uint64_t id, const AcceptedResult& result) {
    const size_t tile = (id - job.first_run_id()) % job.tiles().size();
    for (size_t m = 0; m < result.costs.size(); ++m) {
      TileRow& row = rows[{tile, m, result.worker}];
      row.rect = job.tiles()[tile];
      row.mix = static_cast<int>(m);
      row.worker = result.worker;
      row.passes += result.costs[m].passes;
      row.cpu_seconds += result.costs[m].cpu_seconds;
      row.calibration += result.costs[m].calibration;
    }
  });
  std::vector<TileRow> out;
  out.reserve(rows.size());
  for (auto& [key, row] : rows) out.push_back(std::move(row));
  return out;
}

}  // namespace

std::vector<MixSummary> mix_summaries(const JobRecord& job) {
  std::vector<MixSummary> mixes(job.spec().mixes.size());
  for (size_t m = 0; m < mixes.size(); ++m) {
    mixes[m].mix = job.spec().mixes[m];
    if (job.plan()) mixes[m].planned_passes = job.header.passes[m];
  }
  for (const Substitution& s : job.header.substitutions) mixes[s.mix].substitutions.push_back(s.text);
  add_pilot(job, mixes);
  if (!job.plan()) return mixes;
  std::vector<double> pilot_seconds;  // before the run
  for (const MixSummary& mix : mixes) pilot_seconds.push_back(mix.pilot_cpu_seconds);

  const size_t tiles = job.tiles().size();
  std::vector<std::vector<double>> seconds(job.plan()->boundaries.size(),
                                           std::vector<double>(mixes.size(), 0));
  for_each_result(job, TaskKind::kRun, [&](uint64_t id, const AcceptedResult& result) {
    const size_t range = (id - job.first_run_id()) / tiles;
    for (size_t m = 0; m < mixes.size(); ++m) {
      const MixCost& cost = result.costs[m];
      // The pilot's repetitions count as the pilot does (add_pilot).
      const double seconds_of_mix = cost.cpu_seconds + (mixes[m].mix.automatic ? cost.repilot_seconds : 0);
      mixes[m].cpu_seconds += seconds_of_mix;
      mixes[m].pilot_cpu_seconds += cost.repilot_seconds;
      mixes[m].rays += cost.rays;
      mixes[m].line_queries += cost.line_queries;
      mixes[m].non_finite += cost.non_finite;
      mixes[m].calibration += cost.calibration;
      seconds[range][m] += seconds_of_mix;
    }
  });
  const size_t whole = whole_ranges(job);
  for (size_t m = 0; m < mixes.size(); ++m) {
    double sum = mixes[m].mix.automatic ? pilot_seconds[m] : 0;
    for (size_t range = 0; range < whole; ++range) {
      const PassBoundary& boundary = job.plan()->boundaries[range];
      sum += seconds[range][m];
      mixes[m].passes = boundary.passes[m];
      if (boundary.checkpoint) mixes[m].checkpoints.push_back({boundary.passes[m], sum});
    }
  }
  return mixes;
}

double scheduler_cpu_seconds(const JobRecord& job, const Now& now) {
  const double running = job.final() ? 0 : now.process_cpu - job.scheduler_cpu_base;
  return job.header.scheduler_cpu_seconds + running;
}

JobStatus status_of(const Scheduler& scheduler, const JobRecord& job, const Now& now) {
  JobStatus status;
  status.job = job.header.id;
  status.state = job.header.state;
  status.failure = job.header.failure;
  status.message = job.header.message;
  status.fraction = job.fraction();
  status.tasks_done = job.stage_done();
  status.tasks_total = job.stage_total();
  status.tasks_leased = job.leased();
  status.cpu_seconds = sum_cpu_seconds(job, TaskKind::kRun);
  status.pilot_cpu_seconds = sum_cpu_seconds(job, TaskKind::kPilot);
  status.plan = job.header.passes;
  status.wall_seconds = render_seconds(job, now);
  for (const auto& [id, worker] : scheduler.workers()) {
    ++status.workers;
    status.cores += worker.info.cores;
  }
  status.retries = job.retries();
  status.scene = job.spec().scene;
  status.submitted_unix_seconds = job.header.submitted_unix;
  status.faults = job.header.faults;
  status.terms = job.header.terms;
  if (status.message.empty() && status.state == JobState::kQueued && status.workers == 0)
    status.message = "waiting for a worker: none is connected";
  return status;
}

RunSummary summary_of(const Scheduler& scheduler, const JobRecord& job, const Now& now) {
  RunSummary summary;
  summary.status = status_of(scheduler, job, now);
  summary.spec = job.spec();
  summary.mixes = mix_summaries(job);
  summary.tiles = tile_rows(job);
  std::map<std::string, WorkerInfo> used;
  for (const auto& result : job.results()) {
    if (!result || used.contains(result->worker)) continue;
    const auto known = scheduler.contributors().find(result->worker);
    if (known != scheduler.contributors().end()) used[result->worker] = known->second;
  }
  for (auto& [id, worker] : used) summary.workers.push_back(std::move(worker));
  summary.auto_plans = job.header.auto_plans;
  summary.earlier_plans = job.header.earlier_plans;
  summary.load = job.header.load;
  summary.worker_cpu_seconds = job.header.worker_cpu_seconds;
  summary.render_wall_seconds = render_seconds(job, now);
  summary.total_wall_seconds = std::max(0.0, end_of(job, now) - job.header.submitted_unix);
  if (job.header.first_result_unix != 0)
    summary.first_result_seconds = std::max(0.0, job.header.first_result_unix - job.header.submitted_unix);
  return summary;
}

}  // namespace penumbra

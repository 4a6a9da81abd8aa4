#include "client/run_json.h"

#include <fstream>
#include <iterator>

#include "client/auto_plan_json.h"
#include "client/json_integers.h"
#include "proto/auto_plan.h"
#include "proto/status.h"

namespace penumbra {
namespace {

Json interval_json(const std::optional<ConfidenceInterval>& interval) {
  return interval ? Json::array({interval->low, interval->high}) : Json(nullptr);
}

template <class Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// Spent / budget, for a budget in CPU seconds.
Json budget_ratio(const RunSummary& summary, const MixSummary& mix) {
  const auto* budget = std::get_if<CpuSecondsBudget>(&summary.spec.budget);
  return budget != nullptr ? Json(mix.cpu_seconds / budget->seconds) : Json(nullptr);
}

Json timeline_json(const MixSummary& mix, const MixRecord& record) {
  Json timeline = Json::array();
  for (size_t i = 0; i < mix.checkpoints.size(); ++i) {
    // Boundaries are common to all mixes: a slow one may have nothing yet, or nothing new, at some of them.
    const int64_t passes = mix.checkpoints[i].passes;
    if (passes == 0 || (i + 1 < mix.checkpoints.size() && mix.checkpoints[i + 1].passes == passes)) continue;
    CheckpointError error;
    if (i < record.checkpoints.size()) error = record.checkpoints[i];
    // The last point is the final image, whose own groups of passes say most.
    if (i + 1 == mix.checkpoints.size() && record.own_error && passes == mix.passes) {
      error.estimated_relmse = record.own_error->relmse;
      error.estimated_relmse_ci = record.own_error->relmse_ci;
    }
    timeline.push_back({{"cpu_seconds", mix.checkpoints[i].cpu_seconds},
                        {"passes", passes},
                        {"relmse", or_null(error.relmse)},
                        {"relmse_ci", interval_json(error.relmse_ci)},
                        {"estimated_relmse", or_null(error.estimated_relmse)},
                        {"estimated_relmse_ci", interval_json(error.estimated_relmse_ci)}});
  }
  return timeline;
}

Json calibration_json(const Calibration& c) {
  return {{"units", c.units},
          {"seconds", c.seconds},
          {"seconds_per_unit", c.units > 0 ? Json(c.seconds / static_cast<double>(c.units)) : Json(nullptr)}};
}

/// Six digits: the blocks are many, and their noise is far larger.
Json blocks_json(const ErrorBlocks& blocks) {
  const auto shortened = [](const std::vector<double>& values) {
    Json out = Json::array();
    for (const double value : values) out.push_back(std::stod(fmt::format("{:.6g}", value)));
    return out;
  };
  Json json = {{"edge", blocks.edge}, {"relmse", shortened(blocks.relmse)}};
  if (!blocks.variance.empty()) json["variance"] = shortened(blocks.variance);
  return json;
}

Json mix_json(const RunSummary& summary, const MixSummary& mix, const MixRecord& record) {
  Json regions = Json::object();
  for (const auto& [name, figures] : record.regions)
    regions[name] = {{"rect", to_json(figures.region)},
                     {"relmse", figures.relmse},
                     {"relmse_ci", interval_json(figures.relmse_ci)},
                     {"trimmed_relmse", figures.trimmed_relmse},
                     {"mse", figures.mse},
                     {"reference_floor", or_null(figures.reference_floor)}};
  const std::optional<ErrorFigures>& e = record.error;
  const std::optional<OwnError>& own = record.own_error;
  return {{"mix", record.label},
          {"image", record.image},
          {"passes", mix.passes},
          {"cpu_seconds", mix.cpu_seconds},
          {"budget_ratio", budget_ratio(summary, mix)},
          {"rays", mix.rays},
          {"line_queries", mix.line_queries},
          {"ray_seconds", nullptr},
          {"non_finite", mix.non_finite},
          {"relmse", e ? Json(e->relmse) : Json(nullptr)},
          {"relmse_ci", e ? interval_json(e->relmse_ci) : Json(nullptr)},
          {"trimmed_relmse", e ? Json(e->trimmed_relmse) : Json(nullptr)},
          {"mse", e ? Json(e->mse) : Json(nullptr)},
          {"reference_floor", e ? or_null(e->reference_floor) : Json(nullptr)},
          {"relative_variance", e ? or_null(e->variance) : Json(nullptr)},
          {"estimated_relmse", own ? Json(own->relmse) : Json(nullptr)},
          {"estimated_relmse_ci", own ? interval_json(own->relmse_ci) : Json(nullptr)},
          {"regions", regions},
          {"timeline", timeline_json(mix, record)},
          {"planned_passes", mix.planned_passes},
          {"pilot_cpu_seconds", mix.pilot_cpu_seconds},
          {"substitutions", mix.substitutions},
          {"calibration", calibration_json(mix.calibration)},
          {"error_blocks", e ? blocks_json(e->blocks) : Json(nullptr)}};
}

Calibration total_calibration(const RunSummary& summary) {
  Calibration total;
  for (const MixSummary& mix : summary.mixes) total += mix.calibration;
  return total;
}

Json needs_json(const RunSummary& summary) {
  Json needs = Json::array();
  for (const Need& need : summary.load.needs) needs.push_back({{"effect", need.effect}, {"why", need.why}});
  // Asked for by the job and not by the scene.
  if (const auto& t = summary.spec.transient)
    needs.push_back(
        {{"effect", "transient"}, {"why", fmt::format("--transient {},{},{}", t->t0, t->t1, t->bins)}});
  return needs;
}

Json tiles_json(const RunSummary& summary) {
  Json tiles = Json::array();
  for (const TileRow& row : summary.tiles)
    tiles.push_back({{"rect", to_json(row.rect)},
                     {"mix", row.mix},
                     {"passes", row.passes},
                     {"cpu_seconds", row.cpu_seconds},
                     {"worker", row.worker},
                     {"calibration", calibration_json(row.calibration)}});
  return tiles;
}

Json workers_json(const RunSummary& summary) {
  Json workers = Json::array();
  for (const WorkerInfo& worker : summary.workers)
    workers.push_back(
        {{"id", worker.id}, {"host", worker.host}, {"cores", worker.cores}, {"isa", worker.isa}});
  return workers;
}

Json faults_json(const FaultCounts& faults) {
  return {{"lost_leases", faults.lost_leases},
          {"overdue_leases", faults.overdue_leases},
          {"late_results", faults.late_results},
          {"refused_results", faults.refused_results},
          {"failures", faults.failures},
          {"returned_leases", faults.returned_leases},
          {"corrupt_results", faults.corrupt_results}};
}

Json plan_json(const RunSummary& summary) {
  Json plan = Json::array();
  for (const MixSummary& mix : summary.mixes) plan.push_back(mix.planned_passes);
  return plan;
}

}  // namespace

Json run_json(const RunRecord& run) {
  const RunSummary& s = run.summary;
  PENUMBRA_CHECK(s.mixes.size() == run.mixes.size());
  Json mixes = Json::array();
  for (size_t m = 0; m < run.mixes.size(); ++m) mixes.push_back(mix_json(s, s.mixes[m], run.mixes[m]));
  return {{"schema", 1},
          {"version", PENUMBRA_VERSION},
          {"scene", s.spec.scene},
          {"resolution", Json::array({s.spec.width, s.spec.height})},
          {"seed", s.spec.seed},
          {"budget", to_json(s.spec.budget)},
          {"state", name_of(s.status.state)},
          {"partial", run.partial},
          {"reference", s.spec.reference.empty() ? Json(nullptr) : Json(s.spec.reference)},
          {"needs", needs_json(s)},
          {"transient", to_json(s.spec.transient)},
          {"load", {{"parse_seconds", s.load.parse_seconds}, {"build_seconds", s.load.build_seconds}}},
          {"mixes", mixes},
          {"tiles", tiles_json(s)},
          {"workers", workers_json(s)},
          {"wall_seconds", s.total_wall_seconds},
          {"render_wall_seconds", s.render_wall_seconds},
          {"first_result_seconds", s.first_result_seconds},
          {"worker_cpu_seconds", s.worker_cpu_seconds},
          {"retries", s.status.retries},
          {"faults", faults_json(s.status.faults)},
          {"scheduler", {{"cpu_seconds", run.scheduler_cpu_seconds}}},
          {"warnings", s.load.warnings},
          {"calibration", calibration_json(total_calibration(s))},
          {"plan", plan_json(s)},
          {"auto_plans", auto_plans_json(s.spec, s.auto_plans)},
          {"earlier_plans", earlier_plans_json(s.earlier_plans)},
          {"spec", to_json(s.spec)}};
}

absl::StatusOr<JobSpec> replay_spec(const Json& run) {
  if (!run.is_object() || !run.contains("spec") || !run.contains("plan"))
    return invalid_input("not a run.json that can be replayed: it has no spec and plan");
  ASSIGN_OR_RETURN(JobSpec spec, job_from_json(run["spec"]));
  try {
    spec.plan = integers_of<int64_t>(run["plan"]);
  } catch (const Json::exception& fault) {
    return invalid_input("plan: {}", fault.what());
  }
  if (run.contains("auto_plans")) {
    ASSIGN_OR_RETURN(spec.auto_plans, auto_plans_from_json(run["auto_plans"], spec));
  }
  // Absent where the run had no stages, or an earlier version wrote the file.
  if (run.contains("earlier_plans")) {
    ASSIGN_OR_RETURN(spec.earlier_plans, earlier_plans_from_json(run["earlier_plans"], spec));
  }
  if (spec.auto_plans.empty() && !automatic_mixes(spec.mixes).empty())
    return invalid_input("auto_plans: none; the run ended before `auto` was planned");
  if (spec.plan.size() != spec.mixes.size())
    return invalid_input("plan: {} counts for {} mixes", spec.plan.size(), spec.mixes.size());
  for (const int64_t passes : spec.plan)
    if (passes < 1) return invalid_input("plan: {} passes; the run ended before it was planned", passes);
  return spec;
}

absl::StatusOr<Json> read_json(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return make_status(absl::StatusCode::kNotFound, "{}: no such file", path);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  try {
    return Json::parse(text);
  } catch (const Json::exception& fault) {
    return invalid_input("{}: not JSON: {}", path, fault.what());
  }
}

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace penumbra

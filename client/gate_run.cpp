#include "client/gate_run.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "client/json_integers.h"
#include "client/parse_text.h"
#include "client/run_json.h"
#include "proto/status.h"

namespace penumbra {
namespace {

// What is assumed of CPU per pass in calibration units between runs, where `calibrate` has not measured it;
// the calibration loop's own standard error and the tiles' scatter come on top. As little sure as if five or
// six runs had told it: the loop lies in the first-level cache and does not feel what neighbours do to
// memory. Taken for certain, 3 of 180 pairs of equal runs were called worse where load came and went.
constexpr double kAssumedCpuLogSd = 0.015, kAssumedDegrees = 5;

struct GateMix {
  std::string label;
  GateFigures figures;
};

struct GateRun {
  std::string name;
  std::vector<int64_t> resolution, crop;  ///< crop empty where unknown
  std::string bundle;                     ///< empty where unknown
  int64_t max_depth = 0;                  ///< 0: unknown
  std::optional<std::string> sampler;     ///< nothing where unknown
  std::optional<int64_t> camera_grid;     ///< nothing where unknown
  std::optional<double> unit_seconds;
  double unit_log_error = 0;  ///< standard error of log unit_seconds, from its scatter between tiles
  std::set<std::string> isas;
  std::vector<GateMix> mixes;
};

std::optional<double> number_at(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_number() ? std::optional(json[key].get<double>()) : std::nullopt;
}

GateMix mix_of(const Json& json) {
  GateMix mix;
  mix.label = json.at("mix").get<std::string>();
  GateFigures& f = mix.figures;
  f.passes = json.at("passes").get<double>();
  f.cpu_seconds = json.at("cpu_seconds").get<double>();
  f.relmse = number_at(json, "relmse");
  f.floor = number_at(json, "reference_floor");
  if (json.contains("relmse_ci") && json["relmse_ci"].is_array())
    f.relmse_ci = {json["relmse_ci"].at(0).get<double>(), json["relmse_ci"].at(1).get<double>()};
  f.variance = number_at(json, "relative_variance");
  if (json.contains("error_blocks") && json["error_blocks"].is_object()) {
    const Json& blocks = json["error_blocks"];
    f.block_relmse = blocks.at("relmse").get<std::vector<double>>();
    if (blocks.contains("variance")) f.block_variance = blocks["variance"].get<std::vector<double>>();
  }
  return mix;
}

/// CPU seconds of each tile per mix, and the scatter of the calibration loop between tiles.
void take_tiles(const Json& tiles, GateRun& run) {
  std::map<std::pair<size_t, std::vector<int>>, double> seconds;
  std::vector<double> units;
  for (const Json& row : tiles) {
    seconds[{integer_of<size_t>(row.at("mix")), integers_of<int>(row.at("rect"))}] +=
        row.at("cpu_seconds").get<double>();
    if (!row.contains("calibration")) continue;
    if (const auto unit = number_at(row["calibration"], "seconds_per_unit"); unit && *unit > 0)
      units.push_back(std::log(*unit));
  }
  for (const auto& [key, value] : seconds)
    if (key.first < run.mixes.size()) run.mixes[key.first].figures.tile_seconds.push_back(value);
  if (const auto mean = mean_of(units)) run.unit_log_error = mean->standard_error;
}

/// May throw what nlohmann::json throws.
GateRun read_run(const Json& json) {
  GateRun run;
  run.resolution = integers_of<int64_t>(json.at("resolution"));
  for (const Json& mix : json.at("mixes")) run.mixes.push_back(mix_of(mix));
  if (json.contains("tiles")) take_tiles(json["tiles"], run);
  if (json.contains("calibration")) run.unit_seconds = number_at(json["calibration"], "seconds_per_unit");
  if (json.contains("workers"))
    for (const Json& worker : json["workers"]) run.isas.insert(worker.value("isa", ""));
  if (json.contains("spec")) {
    const Json& spec = json["spec"];
    run.crop = integers_of<int64_t>(spec.at("crop"));
    run.bundle = spec.at("bundle").get<std::string>();
    run.max_depth = integer_of<int64_t>(spec.at("max_depth"));
    if (spec.contains("sampler")) run.sampler = spec["sampler"].get<std::string>();
    if (spec.contains("camera_grid")) run.camera_grid = integer_of<int64_t>(spec["camera_grid"]);
  }
  return run;
}

absl::StatusOr<GateRun> gate_run(const Json& json, const std::string& name) {
  if (!json.is_object() || json.value("schema", 0) != 1)
    return invalid_input("{}: not a run.json of schema 1", name);
  if (json.value("partial", false)) return invalid_input("{}: the run was interrupted", name);
  GateRun run;
  try {
    run = read_run(json);
  } catch (const Json::exception& fault) {
    return invalid_input("{}: {}", name, fault.what());
  }
  run.name = name;
  for (const GateMix& mix : run.mixes) {
    if (!mix.figures.relmse)
      return invalid_input("{}: mix {} has no error figure; render it with --reference", name, mix.label);
    if (!(mix.figures.passes > 0)) return invalid_input("{}: mix {} has no passes", name, mix.label);
    const GateFigures& f = mix.figures;
    if (!f.block_variance.empty() && f.block_variance.size() != f.block_relmse.size())
      return invalid_input("{}: mix {}: error_blocks has {} of relmse and {} of variance", name, mix.label,
                           f.block_relmse.size(), f.block_variance.size());
  }
  return run;
}

absl::Status check_comparable(const GateRun& now, const GateRun& before) {
  const auto differ = [&](const char* what) {
    return invalid_input("{} and {} differ in {}: they cannot be compared; make a new baseline", now.name,
                         before.name, what);
  };
  if (now.resolution != before.resolution) return differ("resolution");
  if (now.bundle.empty() || before.bundle.empty()) return absl::OkStatus();
  if (now.crop != before.crop) return differ("the rendered part (--crop)");
  if (now.max_depth != before.max_depth) return differ("--max-depth");
  if (now.sampler && before.sampler && now.sampler != before.sampler) return differ("--sampler");
  if (now.camera_grid && before.camera_grid && now.camera_grid != before.camera_grid)
    return differ("--camera-grid");
  if (now.bundle != before.bundle) return differ("the scene's files");
  return absl::OkStatus();
}

/// Why error per pass tells nothing of these two, or "".
std::string other_patterns(const GateMix& now, const GateMix& before, const GateRun& run,
                           const GateRun& base) {
  const bool independent = run.sampler == name_of(SamplerKind::kIndependent) && base.sampler == run.sampler;
  return independent ? "" : patterns_differ(now.figures.passes, before.figures.passes);
}

/// log(old / new seconds per unit) and what is known of the noise of CPU per pass between two runs.
std::optional<Estimate> scale_of(const GateRun& now, const GateRun& before, const GateOptions& options) {
  if (!now.unit_seconds || !before.unit_seconds) return std::nullopt;
  Estimate scale;
  scale.value = std::log(*before.unit_seconds / *now.unit_seconds);
  if (options.noise) {
    scale.standard_error = options.noise->cpu_log_sd * std::sqrt(2.0);
    scale.degrees_of_freedom = options.noise->degrees_of_freedom;
  } else {
    scale.standard_error = std::hypot(std::hypot(kAssumedCpuLogSd, now.unit_log_error),
                                      std::hypot(kAssumedCpuLogSd, before.unit_log_error));
    scale.degrees_of_freedom = kAssumedDegrees;
  }
  return scale;
}

GateRow cpu_row(const GateMix& now, const GateMix& before, const GateRun& run, const GateRun& base,
                const GateOptions& options) {
  GateRow row{now.label, std::string(kCpuPerPass), {}, options.cpu_tolerance, {}, ""};
  const std::optional<Estimate> scale = scale_of(run, base, options);
  if (!scale) {
    row.note = "not judged: a run without calibration";
    return row;
  }
  const LogRatio ratio = cpu_ratio(now.figures, before.figures, *scale, options.noise.has_value());
  row.log_ratio = ratio.estimate;
  row.note = ratio.why_not;
  if (run.isas != base.isas) row.note = "not judged: the runs used different vector instruction sets";
  if (!row.log_ratio && row.note.empty()) row.note = "not judged";
  return row;
}

/// How much more of a picture an inconclusive row would want if nothing has changed. Not how many more
/// passes: a run has few groups of them, however long it is, and relMSE one square a pixel.
std::string advice(const GateRow& row) {
  const Estimate& e = *row.log_ratio;
  const double half = interval({0, e.standard_error, e.degrees_of_freedom}, 1 - 2 * kMissed).high;
  const double limit = std::log1p(row.tolerance);
  if (row.figure == kCpuPerPass || !(half > 0)) return "";
  return fmt::format(
      "±{:.1f} % is too uncertain for {:.3g} %: a picture of about {:.1f} times the lit pixels would do",
      100 * std::expm1(half), 100 * row.tolerance, std::max(1.0, std::pow(2 * half / limit, 2)));
}

}  // namespace

absl::StatusOr<NoiseFloor> noise_from_json(const Json& json) {
  try {
    const Json& cpu = json.at("cpu_per_pass");
    NoiseFloor noise{cpu.at("log_sd").get<double>(), cpu.at("degrees_of_freedom").get<double>()};
    if (!(noise.cpu_log_sd >= 0) || !(noise.degrees_of_freedom > 0))
      return invalid_input("--noise: a spread below 0, or without degrees of freedom");
    return noise;
  } catch (const Json::exception& fault) {
    return invalid_input("--noise: not what `penumbra calibrate --json` prints: {}", fault.what());
  }
}

std::string patterns_differ(double now, double before) {
  if (now == before) return "";
  return fmt::format(
      "{:.0f} passes, and {:.0f} before: with samples that are stratified over passes error falls faster "
      "than "
      "1/passes, so equal numbers (--spp) or --sampler independent are needed",
      now, before);
}

std::vector<GateRow> error_rows(const std::string& mix, const GateFigures& now, const GateFigures& before,
                                const GateOptions& options, const std::string& why_not) {
  if (!why_not.empty()) return {{mix, "error per pass", {}, options.tolerance, {}, why_not}};
  const LogRatio error = error_ratio(now, before);
  std::vector<GateRow> rows = {{mix, "error per pass", error.estimate, options.tolerance, {}, error.why_not}};
  // Where it cannot be told the first row stands alone.
  if (const auto typical = typical_ratio(now, before); typical && typical->estimate)
    rows.push_back({mix, "typical error", typical->estimate, options.tolerance, {}, ""});
  if (const auto excess = excess_ratio(now, before))
    rows.push_back({mix,
                    "error/variance",
                    excess->estimate,
                    std::max(options.tolerance, kExcessTolerance),
                    {},
                    excess->why_not});
  return rows;
}

void judge_rows(GateResult& result) {
  const auto judged = [](const GateRow& row) { return row.log_ratio && row.note.empty(); };
  const auto figures = std::count_if(result.rows.begin(), result.rows.end(), judged);
  std::vector<Verdict> verdicts;
  for (GateRow& row : result.rows) {
    if (judged(row)) {
      row.verdict = judge(*row.log_ratio, row.tolerance, figures);
      if (row.verdict == Verdict::kInconclusive) row.note = advice(row);
    } else if (!row.log_ratio && row.figure != kCpuPerPass) {
      row.verdict = Verdict::kInconclusive;
    }
    if (row.verdict) verdicts.push_back(*row.verdict);
  }
  result.verdict = worst(verdicts);
}

absl::StatusOr<GateResult> gate_runs(const Json& now_json, const std::string& now_name,
                                     const Json& before_json, const std::string& before_name,
                                     const GateOptions& options) {
  ASSIGN_OR_RETURN(const GateRun now, gate_run(now_json, now_name));
  ASSIGN_OR_RETURN(const GateRun before, gate_run(before_json, before_name));
  RETURN_IF_ERROR(check_comparable(now, before));
  GateResult result;
  std::set<std::string> gated;
  for (const GateMix& old : before.mixes) {
    const auto same = std::find_if(now.mixes.begin(), now.mixes.end(),
                                   [&](const GateMix& mix) { return mix.label == old.label; });
    if (same == now.mixes.end())
      return invalid_input("{}: mix {} of the baseline is missing", now_name, old.label);
    gated.insert(old.label);
    const std::string why_not = other_patterns(*same, old, now, before);
    for (GateRow& row : error_rows(old.label, same->figures, old.figures, options, why_not))
      result.rows.push_back(std::move(row));
    result.rows.push_back(cpu_row(*same, old, now, before, options));
  }
  for (const GateMix& mix : now.mixes)
    if (!gated.contains(mix.label))
      result.notes.push_back(fmt::format("{} is not in the baseline: not judged", mix.label));
  judge_rows(result);
  return result;
}

absl::StatusOr<Json> baseline_of(const Json& run, const std::string& name) {
  RETURN_IF_ERROR(gate_run(run, name).status());
  Json out = {{"schema", 1}};
  try {
    for (const char* key : {"version", "resolution", "seed", "budget", "calibration"})
      if (run.contains(key)) out[key] = run[key];
    out["mixes"] = Json::array();
    for (const Json& mix : run["mixes"]) {
      Json kept;
      for (const char* key : {"mix", "passes", "cpu_seconds", "relmse", "relmse_ci", "relative_variance",
                              "reference_floor", "calibration", "error_blocks"})
        if (mix.contains(key)) kept[key] = mix[key];
      out["mixes"].push_back(kept);
    }
    out["tiles"] = Json::array();
    if (run.contains("tiles"))
      for (Json row : run["tiles"]) {
        row.erase("worker");
        out["tiles"].push_back(row);
      }
    out["workers"] = Json::array();
    if (run.contains("workers"))
      for (const Json& worker : run["workers"]) out["workers"].push_back({{"isa", worker.value("isa", "")}});
    if (run.contains("spec"))
      for (const char* key : {"bundle", "sampler", "camera_grid", "crop", "max_depth", "tile"})
        out["spec"][key] = run["spec"].at(key);
  } catch (const Json::exception& fault) {
    return invalid_input("{}: {}", name, fault.what());
  }
  return out;
}

}  // namespace penumbra

#include <cmath>
#include <cstdio>
#include <memory>

#include "client/commands.h"
#include "client/exit_code.h"
#include "client/noise_floor.h"
#include "client/outcome.h"
#include "client/quiet_run.h"
#include "client/run_job.h"
#include "proto/status.h"

namespace penumbra {
namespace {

constexpr int64_t kMostRuns = 1000;
constexpr const char* kDefaultRuns = "5";
constexpr const char* kDefaultBudget = "2s";
// Where neither the command line nor the scene names one.
constexpr const char* kDefaultMix = "bsdf:1+sa:1";

struct CalibrateOptions {
  JobOptions job;
  ServerOptions server;
  ClusterOptions cluster;
  std::string runs = kDefaultRuns;
  bool json = false, quiet = false;
};

/// Error of one pass: against the reference, else what the image's own variance says.
absl::StatusOr<double> error_per_pass(const FilmImage& image, const std::optional<FilmImage>& reference,
                                      double passes) {
  if (reference) {
    ASSIGN_OR_RETURN(const ErrorFigures error, compare(image, *reference));
    return error.relmse * passes;
  }
  double sum = 0;
  for (size_t i = 0; i < image.rgb.size(); ++i)
    sum += image.variance[i] / (double{image.rgb[i]} * image.rgb[i] + kRelMseEpsilon);
  return sum / static_cast<double>(image.rgb.size()) * passes;
}

absl::StatusOr<NullRun> null_run(const FetchedRun& run, const std::optional<FilmImage>& reference) {
  NullRun out;
  Calibration calibration;
  for (size_t m = 0; m < 2; ++m) {
    const MixSummary& mix = run.summary.mixes[m];
    const auto passes = static_cast<double>(mix.passes);
    out.seconds_per_pass[m] = mix.cpu_seconds / passes;
    ASSIGN_OR_RETURN(out.error_per_pass[m], error_per_pass(run.images[m], reference, passes));
    if (!(out.error_per_pass[m] > 0))
      return make_status(absl::StatusCode::kFailedPrecondition,
                         "the image shows no noise at all: nothing to calibrate with");
    calibration += mix.calibration;
  }
  if (calibration.units == 0)
    return make_status(absl::StatusCode::kFailedPrecondition,
                       "the workers timed no calibration loop: they are of an older version");
  out.unit_seconds = calibration.seconds / static_cast<double>(calibration.units);
  return out;
}

/// The job of the first run: the mix twice.
absl::StatusOr<Submission> prepare_null(CalibrateOptions& o) {
  if (!o.job.regions.empty())
    return invalid_input("--region: calibrate tells the noise of whole pictures; --crop renders a part");
  if (o.job.mixes.size() > 1) return invalid_input("--mix: calibrate renders one mix, twice; name one");
  if (o.job.budget.empty() && o.job.passes.empty() && o.job.target_error.empty())
    o.job.budget = kDefaultBudget;
  ASSIGN_OR_RETURN(Submission submission, prepare(o.job));
  std::vector<Mix>& mixes = submission.spec.mixes;
  mixes.resize(1);
  // `auto` plans anew in each run: what it costs is no property of the machine.
  if (mixes[0].automatic && !o.job.mixes.empty())
    return invalid_input("--mix: auto plans anew in each run; name a mix");
  if (mixes[0].automatic) {
    ASSIGN_OR_RETURN(mixes[0], parse_mix(kDefaultMix));
  }
  mixes.push_back(mixes[0]);
  return submission;
}

absl::StatusOr<Json> calibrate(CalibrateOptions& o, NoiseFigures& noise, std::stop_token stop) {
  ASSIGN_OR_RETURN(const int64_t count, parse_whole("--runs", o.runs, 2, kMostRuns));
  ASSIGN_OR_RETURN(const Submission submission, prepare_null(o));
  std::optional<FilmImage> reference;
  if (!submission.spec.reference.empty()) {
    ASSIGN_OR_RETURN(reference, read_reference(submission.spec));
  }
  Progress progress(Progress::style_for(o.quiet));
  for (const std::string& warning : submission.warnings) progress.note("warning: " + warning);
  ASSIGN_OR_RETURN(const std::unique_ptr<Backend> backend, open_backend(o.server, o.cluster));
  RETURN_IF_ERROR(backend->server->upload(submission.bundle, stop));
  std::vector<NullRun> runs;
  std::vector<WorkerInfo> workers;
  for (int64_t r = 0; r < count; ++r) {
    JobSpec spec = submission.spec;
    spec.seed += static_cast<uint64_t>(r);
    progress.note(fmt::format("run {} of {}", r + 1, count));
    ASSIGN_OR_RETURN(const FetchedRun run, run_quietly(*backend->server, spec, stop,
                                                       [&](const JobStatus&) { return backend->tend(); }));
    ASSIGN_OR_RETURN(const NullRun one, null_run(run, reference));
    runs.push_back(one);
    workers = run.summary.workers;
  }
  noise = noise_of(runs);
  Json json = noise_json(noise);
  json["scene"] = submission.spec.scene;
  json["mix"] = label(submission.spec.mixes[0]);
  json["budget"] = to_json(submission.spec.budget);
  json["runs"] = count;
  json["error_from"] = reference ? "reference" : "variance of the image";
  json["workers"] = Json::array();
  for (const WorkerInfo& worker : workers)
    json["workers"].push_back({{"host", worker.host}, {"isa", worker.isa}, {"cores", worker.cores}});
  return json;
}

}  // namespace

void add_calibrate(CLI::App& app, Chosen& chosen) {
  CLI::App* command =
      app.add_subcommand("calibrate", "Render one mix twice, several times: this machine's noise floor");
  auto options = std::make_shared<CalibrateOptions>();
  add_job_options(*command, options->job);
  command->get_option("--budget")->description("CPU seconds per mix and run: 500ms, 30s, 2m (default 2s)");
  command->add_option("--runs", options->runs, "Runs, each with its own seed")
      ->type_name("N")
      ->capture_default_str();
  command->add_flag("--json", options->json, "As JSON: what gate --noise reads");
  command->add_flag("--quiet", options->quiet, "No progress");
  add_cluster_options(*command, options->cluster);
  add_server_options(*command, options->server, false);
  command->callback([options, &chosen] {
    chosen.run = [options](std::stop_token stop) {
      NoiseFigures noise;
      const absl::StatusOr<Json> json = calibrate(*options, noise, stop);
      if (!json.ok()) return tell(json.status());
      fmt::print("{}", options->json ? json_text(*json) : noise_text(noise));
      return static_cast<int>(kExitDone);
    };
  });
}

}  // namespace penumbra

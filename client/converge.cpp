#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>

#include "client/commands.h"
#include "client/convergence.h"
#include "client/integrand.h"
#include "client/output_folder.h"
#include "client/parse_text.h"
#include "client/quiet_run.h"
#include "client/run_job.h"
#include "client/run_json.h"
#include "film/atomic_file.h"
#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kMostEstimates = 1 << 24;
constexpr int64_t kMostFactor = 65536;
constexpr int64_t kMostGrid = 4096;

struct ConvergeOptions {
  JobOptions job;
  ServerOptions server;
  ClusterOptions cluster;
  OutputOptions output;
  std::string pixel, estimates = "1000", most = "1024", light = "0", grid = "256";
  bool integrand = false;
};

/// What has no meaning here is refused rather than ignored.
absl::Status check_options(const JobOptions& o) {
  if (!o.budget.empty() || !o.passes.empty() || !o.target_error.empty())
    return invalid_input("--estimates says how much converge renders, not --budget, --spp or --target-error");
  if (!o.transient.empty()) return invalid_input("--transient: converge makes no picture to sort into bins");
  if (!o.crop.empty() || !o.regions.empty() || !o.reference.empty())
    return invalid_input("converge looks at one pixel: --crop, --region and --reference have no meaning");
  return absl::OkStatus();
}

struct Prepared {
  Submission submission;  ///< of the picture: mixes and image as the options say
  PixelPlace pixel;
  fs::path folder;
};

absl::StatusOr<Prepared> prepare_converge(const ConvergeOptions& o) {
  RETURN_IF_ERROR(check_options(o.job));
  Prepared prepared;
  ASSIGN_OR_RETURN(prepared.pixel, parse_pixel("--pixel", o.pixel));
  ASSIGN_OR_RETURN(prepared.submission, prepare(o.job));
  // Where neither the command line nor the scene names mixes: the strategies, alone and together.
  std::vector<Mix>& mixes = prepared.submission.spec.mixes;
  if (o.job.mixes.empty() && mixes[0].automatic) {
    mixes.clear();
    for (const char* text : {"bsdf:1", "sa:1", "line-sa@u:1", "line-sa@v:1", "bsdf:1+line-sa@v:1"}) {
      ASSIGN_OR_RETURN(Mix mix, parse_mix(text));
      mixes.push_back(std::move(mix));
    }
  }
  prepared.folder = o.output.out.empty() ? default_folder(o.job.scene) + "-converge" : o.output.out;
  RETURN_IF_ERROR(prepare_folder(prepared.folder));
  return prepared;
}

/// Renders a probe with the picture's bundle.
absl::StatusOr<FetchedRun> render_probe(const ConvergeOptions& o, const Submission& submission,
                                        const JobSpec& spec, std::stop_token stop) {
  Progress progress(Progress::style_for(o.output.quiet));
  for (const std::string& warning : submission.warnings) progress.note("warning: " + warning);
  ASSIGN_OR_RETURN(const std::unique_ptr<Backend> backend, open_backend(o.server, o.cluster));
  RETURN_IF_ERROR(backend->server->upload(submission.bundle, stop));
  return run_quietly(*backend->server, spec, stop, [&](const JobStatus& status) {
    progress.show(status);
    return backend->tend();
  });
}

Json header_json(const Prepared& prepared) {
  const JobSpec& picture = prepared.submission.spec;
  return {{"schema", 1},
          {"version", PENUMBRA_VERSION},
          {"scene", picture.scene},
          {"resolution", Json::array({picture.width, picture.height})},
          {"pixel", Json::array({prepared.pixel.x, prepared.pixel.y})},
          {"sampler", name_of(picture.sampler)},
          {"seed", picture.seed}};
}

std::string where(const Prepared& prepared) {
  return fmt::format("{}, pixel {},{}", fs::path(prepared.submission.spec.scene).filename().string(),
                     prepared.pixel.x, prepared.pixel.y);
}

/// Prints the outcome: JSON, or text and where the files are.
void tell_outcome(const ConvergeOptions& o, const Json& json, const std::string& text, const fs::path& folder,
                  std::initializer_list<const char*> files) {
  if (o.output.json) {
    fmt::print("{}", json_text(json));
    return;
  }
  if (o.output.quiet) return;
  fmt::print("{}", text);
  for (const char* name : files)
    fmt::print("{}\n", (fs::absolute(folder).lexically_normal() / name).string());
}

absl::Status converge(const ConvergeOptions& o, std::stop_token stop) {
  ASSIGN_OR_RETURN(const int64_t estimates, parse_whole("--estimates", o.estimates, 8, kMostEstimates));
  ASSIGN_OR_RETURN(const int64_t most, parse_whole("--most", o.most, 4, kMostFactor));
  ASSIGN_OR_RETURN(const Prepared prepared, prepare_converge(o));
  const JobSpec& picture = prepared.submission.spec;
  const std::vector<int> factors = square_factors(static_cast<int>(most));
  ASSIGN_OR_RETURN(const JobSpec job,
                   convergence_job(picture, prepared.pixel.x, prepared.pixel.y, factors, estimates));
  ASSIGN_OR_RETURN(const FetchedRun run, render_probe(o, prepared.submission, job, stop));
  const std::vector<ConvergenceCurve> curves = curves_of(picture, job, factors, run.images);
  Json json = header_json(prepared);
  std::string text = convergence_text(curves);
  json["substitutions"] = Json::array();
  for (size_t m = 0; m < curves.size(); ++m)
    for (const std::string& change : run.summary.mixes[m * factors.size()].substitutions) {
      json["substitutions"].push_back(curves[m].mix + ": " + change);
      text += fmt::format("note: {}: {}\n", curves[m].mix, change);
    }
  json["mixes"] = convergence_json(curves);
  RETURN_IF_ERROR(write_file_atomically(prepared.folder / "converge.json", json_text(json)));
  RETURN_IF_ERROR(
      write_file_atomically(prepared.folder / "converge.svg", convergence_svg(curves, where(prepared))));
  tell_outcome(o, json, text, prepared.folder, {"converge.json", "converge.svg"});
  return absl::OkStatus();
}

absl::Status draw_integrands(const ConvergeOptions& o, std::stop_token stop) {
  ASSIGN_OR_RETURN(const int64_t light, parse_whole("--light", o.light, 0, std::numeric_limits<int>::max()));
  ASSIGN_OR_RETURN(const int64_t grid, parse_whole("--grid", o.grid, 2, kMostGrid));
  ASSIGN_OR_RETURN(const Prepared prepared, prepare_converge(o));
  ASSIGN_OR_RETURN(const IntegrandJob job,
                   integrand_job(prepared.submission.spec, prepared.pixel.x, prepared.pixel.y,
                                 static_cast<int>(light), static_cast<int>(grid)));
  ASSIGN_OR_RETURN(const FetchedRun run, render_probe(o, prepared.submission, job.spec, stop));
  double largest = 0;
  for (const FilmImage& image : run.images) largest = std::max(largest, figures_of(image).largest);
  if (!(largest > 0))
    return invalid_input(
        "--pixel: nothing of area light {} reaches the surface at pixel {},{}, or the scene has no such "
        "light or "
        "surface there",
        light, prepared.pixel.x, prepared.pixel.y);
  Json json = header_json(prepared);
  json["light"] = light;
  ASSIGN_OR_RETURN(json["integrands"], write_integrands(job, run.images, prepared.folder));
  RETURN_IF_ERROR(write_file_atomically(prepared.folder / "integrand.json", json_text(json)));
  std::string text =
      fmt::format("{:40}  {:14}  {:>10}  {:>10}  {:>9}\n", "mix", "strategy", "mean", "largest", "variation");
  for (const Json& part : json["integrands"])
    text += fmt::format("{:40}  {:14}  {:>10.4g}  {:>10.4g}  {:>9.3g}\n", part["mix"].get<std::string>(),
                        part["strategy"].get<std::string>(), part["mean"].get<double>(),
                        part["largest"].get<double>(), part["variation"].get<double>());
  tell_outcome(o, json, text, prepared.folder, {"integrand.json", "integrand.html"});
  return absl::OkStatus();
}

}  // namespace

void add_converge(CLI::App& app, Chosen& chosen) {
  CLI::App* command =
      app.add_subcommand("converge", "Variance against light samples at one pixel, with fitted slopes");
  auto options = std::make_shared<ConvergeOptions>();
  add_job_options(*command, options->job);
  command->add_option("--pixel", options->pixel, "The pixel; its centre is looked at")
      ->required()
      ->type_name("X,Y");
  command->add_option("--estimates", options->estimates, "Independent estimates for each number of samples")
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--most", options->most, "Largest factor on the mixes' counts; squares up to it are tried")
      ->type_name("N")
      ->capture_default_str();
  command->add_flag("--integrand", options->integrand,
                    "Draw w·f/p over a light instead, for every strategy of every mix");
  command->add_option("--light", options->light, "Which area light, in the scene's order")
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--grid", options->grid, "Points along each edge of the light")
      ->type_name("N")
      ->capture_default_str();
  for (const char* flag : {"--light", "--grid"})
    command->get_option(flag)->needs(command->get_option("--integrand"));
  for (const char* flag : {"--estimates", "--most"})
    command->get_option(flag)->excludes(command->get_option("--integrand"));
  add_output_options(*command, options->output);
  command->get_option("--out")->description(
      "Folder for the table and the pictures (default ./penumbra-out/<scene>-converge)");
  command->get_option("--json")->description("Standard output is exactly converge.json, or integrand.json");
  add_cluster_options(*command, options->cluster);
  add_server_options(*command, options->server, false);
  command->callback([options, &chosen] {
    chosen.run = [options](std::stop_token stop) {
      return tell(options->integrand ? draw_integrands(*options, stop) : converge(*options, stop));
    };
  });
}

}  // namespace penumbra

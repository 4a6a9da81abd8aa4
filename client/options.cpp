#include "client/options.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>

#include "film/film_image.h"
#include "proto/status.h"

namespace penumbra {
namespace {

constexpr int64_t kMostWorkers = 1024;
constexpr int64_t kMostPasses = int64_t{1} << 40;

/// What is rendered where neither the command line nor the scene says.
constexpr const char* kDefaultMix = "auto";

/// Edge of a tile where `auto` is rendered: a quarter of the pixels of the usual tile, because each tile has
/// one plan, and smaller parts of a picture are more of one kind.
constexpr int kAutoTile = 32;

absl::StatusOr<std::vector<Mix>> mixes_of(const JobOptions& options, const SceneDefaults& scene) {
  std::vector<Mix> mixes;
  for (const std::string& text : options.mixes) {
    ASSIGN_OR_RETURN(Mix mix, parse_mix(text));
    mixes.push_back(std::move(mix));
  }
  if (mixes.empty() && scene.mix) mixes.push_back(*scene.mix);
  if (mixes.empty()) {
    ASSIGN_OR_RETURN(Mix mix, parse_mix(kDefaultMix));
    mixes.push_back(std::move(mix));
  }
  return mixes;
}

absl::StatusOr<Budget> budget_of(const JobOptions& options, const SceneDefaults& scene) {
  const auto given = !options.budget.empty() + !options.passes.empty() + !options.target_error.empty();
  if (given > 1) return invalid_input("--budget, --spp and --target-error exclude one another");
  if (!options.budget.empty()) {
    ASSIGN_OR_RETURN(const double seconds, parse_duration("--budget", options.budget));
    return CpuSecondsBudget{seconds};
  }
  if (!options.passes.empty()) {
    ASSIGN_OR_RETURN(const int64_t passes, parse_whole("--spp", options.passes, 1, kMostPasses));
    return SppBudget{passes};
  }
  if (!options.target_error.empty()) {
    ASSIGN_OR_RETURN(const double error, parse_positive("--target-error", options.target_error));
    return TargetErrorBudget{error};
  }
  return SppBudget{scene.passes};
}

absl::Status set_image(const JobOptions& options, const SceneDefaults& scene, JobSpec& job) {
  job.width = scene.width;
  job.height = scene.height;
  if (!options.resolution.empty()) {
    ASSIGN_OR_RETURN(const Resolution resolution, parse_resolution("--resolution", options.resolution));
    job.width = resolution.width;
    job.height = resolution.height;
  }
  const PixelRect full{0, 0, job.width, job.height};
  if (options.crop.empty()) {
    ASSIGN_OR_RETURN(job.crop, scene.crop(job.width, job.height));
  } else {
    ASSIGN_OR_RETURN(job.crop, parse_rect("--crop", options.crop));
    if (!contains(full, job.crop))
      return invalid_input("--crop: {} does not lie in {}x{}", options.crop, job.width, job.height);
  }
  std::set<std::string> names;
  for (const std::string& text : options.regions) {
    ASSIGN_OR_RETURN(Region region, parse_region("--region", text));
    if (!contains(job.crop, region.rect))
      return invalid_input("--region: '{}' does not lie in the rendered {},{},{},{}", text, job.crop.x0,
                           job.crop.y0, job.crop.x1, job.crop.y1);
    if (!names.insert(region.name).second) return invalid_input("--region: '{}' is named twice", region.name);
    job.regions.push_back(std::move(region));
  }
  return absl::OkStatus();
}

}  // namespace

void add_server_options(CLI::App& app, ServerOptions& o, bool from_environment) {
  CLI::Option* server = app.add_option("--server", o.address, "The server")->type_name("HOST:PORT");
  if (from_environment) server->envname("PENUMBRA_SERVER");
  app.add_option("--tls-cert", o.credentials.cert, "Client certificate (PEM)")->type_name("FILE");
  app.add_option("--tls-key", o.credentials.key, "Its private key (PEM)")->type_name("FILE");
  app.add_option("--tls-ca", o.credentials.ca, "Authority that signed the server's certificate (PEM)")
      ->type_name("FILE");
  app.add_option("--token-file", o.credentials.token_file, "File with a bearer token")->type_name("FILE");
  // Not with the environment's: whoever sets no address there is told that one is missing.
  if (from_environment) return;
  for (const char* flag : {"--tls-cert", "--tls-key", "--tls-ca", "--token-file"})
    app.get_option(flag)->needs(server);
}

void add_cluster_options(CLI::App& app, ClusterOptions& o) {
  app.add_option("--workers", o.workers, "Worker processes of the local cluster (default 2)")->type_name("N");
  app.add_option("--threads", o.threads, "Threads of each (default: cores / workers)")->type_name("N");
}

absl::StatusOr<ClusterSize> cluster_size(const ClusterOptions& o, int cores) {
  ClusterSize size;
  if (!o.workers.empty()) {
    ASSIGN_OR_RETURN(const int64_t workers, parse_whole("--workers", o.workers, 1, kMostWorkers));
    size.workers = static_cast<int>(workers);
  }
  size.threads = std::max(1, cores / size.workers);
  if (!o.threads.empty()) {
    ASSIGN_OR_RETURN(const int64_t threads, parse_whole("--threads", o.threads, 1, kMostWorkers));
    size.threads = static_cast<int>(threads);
  }
  return size;
}

void refuse_empty_values(CLI::App& app) {
  for (CLI::Option* const option :
       app.get_options([](const CLI::Option* o) { return o->get_items_expected() > 0; }))
    option->check(
        [](const std::string& value) { return std::string(value.empty() ? "must not be empty" : ""); });
}

std::string first_given(const CLI::App& app, const std::vector<std::string>& flags) {
  const auto given =
      std::find_if(flags.begin(), flags.end(), [&](const std::string& flag) { return app.count(flag) > 0; });
  return given == flags.end() ? "" : *given;
}

std::vector<std::string> job_flags() {
  // Asked of the options themselves, so that none is forgotten when one is added.
  CLI::App app;
  JobOptions unused;
  add_job_options(app, unused);
  std::vector<std::string> flags;
  for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return !o->get_positional(); }))
    if (option->get_name() != "--help") flags.push_back(option->get_name());
  return flags;
}

void add_job_options(CLI::App& app, JobOptions& o) {
  app.add_option("scene", o.scene, "Scene file (pbrt-v3 or v4)")->required()->type_name("SCENE.pbrt");
  app.add_option(
         "--mix", o.mixes,
         "strategy[:count] joined by +, then /combination; repeatable. "
         "Strategies: bsdf area sa visible-area line-area@DEG line-uniform@DEG line-analytic@DEG line-sa@u "
         "line-sa@v. "
         "Combinations: /balance (default) /free /power /average /smooth=WIDTH|auto /smooth-ease=WIDTH|auto. "
         "Last, where there are media: /medium=point (default) or /medium=line, lit by lines from the "
         "lights. "
         "Last, where the camera has a lens: /lens=point (default) or /lens=line, chords of it. "
         "Last, where something moves: /motion=point (default) or /motion=line, intervals of time. "
         "Last, for a pinhole: /pixel=point (default) or /pixel=line, lines across the pixel. "
         "Or auto, alone: the planner chooses for each tile. "
         "Default: the scene's Integrator \"pointline\", else auto")
      ->type_name("MIX")
      ->allow_extra_args(false);
  app.add_option("--budget", o.budget, "CPU seconds per mix: 500ms, 30s, 2m")->type_name("DURATION");
  app.add_option("--spp", o.passes, "Camera samples per pixel")->type_name("N");
  app.add_option("--target-error", o.target_error, "Until relMSE is estimated below E")->type_name("E");
  app.add_option("--sampler", o.sampler, "independent, stratified (default) or sobol")->type_name("KIND");
  app.add_option("--reference", o.reference, "Reference image: error columns")->type_name("REF.exr");
  app.add_option("--region", o.regions, "NAME=X0,Y0,X1,Y1 in pixels, half-open; repeatable")
      ->type_name("REGION")
      ->allow_extra_args(false);
  app.add_option("--resolution", o.resolution, "Instead of the scene's")->type_name("WxH");
  app.add_option("--crop", o.crop, "Render only these pixels, half-open")->type_name("X0,Y0,X1,Y1");
  app.add_option("--max-depth", o.max_depth, "Vertices with direct light; above 1 along specular chains")
      ->type_name("N");
  app.add_option("--tile", o.tile, "Edge of a tile, pixels (default 64; with auto 32)")->type_name("N");
  app.add_option("--camera-grid", o.camera_grid,
                 "Camera samples only at the centres of NxN cells a pixel, as some references are made")
      ->type_name("N");
  app.add_option(
         "--transient", o.transient,
         "Also sort light by the length of its path from the camera (scene units) into BINS equal bins over "
         "[T0,T1): further parts of each EXR, and a flip-book in the report")
      ->type_name("T0,T1,BINS");
  app.add_option("--seed", o.seed, "Random seed (default 0)")->type_name("N");
  app.add_flag("--strict", o.strict, "Warnings about the scene are errors");
  refuse_empty_values(app);
}

absl::StatusOr<JobSpec> make_job(const JobOptions& o, const SceneDefaults& scene) {
  JobSpec job;
  job.scene = std::filesystem::absolute(o.scene).lexically_normal();
  job.strict = o.strict;
  ASSIGN_OR_RETURN(job.mixes, mixes_of(o, scene));
  ASSIGN_OR_RETURN(job.budget, budget_of(o, scene));
  RETURN_IF_ERROR(set_image(o, scene, job));
  if (!o.sampler.empty()) {
    ASSIGN_OR_RETURN(job.sampler, parse_sampler("--sampler", o.sampler));
  }
  job.max_depth = scene.max_depth;
  if (!o.max_depth.empty()) {
    ASSIGN_OR_RETURN(const int64_t depth, parse_whole("--max-depth", o.max_depth, 1, kMostDepth));
    job.max_depth = static_cast<int>(depth);
  }
  const auto automatic = [](const Mix& mix) { return mix.automatic; };
  if (std::any_of(job.mixes.begin(), job.mixes.end(), automatic)) job.tile = kAutoTile;
  if (!o.tile.empty()) {
    ASSIGN_OR_RETURN(const int64_t tile, parse_whole("--tile", o.tile, 1, kMostTile));
    job.tile = static_cast<int>(tile);
  }
  if (!o.camera_grid.empty()) {
    ASSIGN_OR_RETURN(const int64_t grid, parse_whole("--camera-grid", o.camera_grid, 1, kMostCameraGrid));
    job.camera_grid = static_cast<int>(grid);
  }
  if (!o.seed.empty()) {
    ASSIGN_OR_RETURN(job.seed, parse_seed("--seed", o.seed));
  }
  if (!o.transient.empty()) {
    ASSIGN_OR_RETURN(job.transient, parse_transient("--transient", o.transient));
    if (const std::string fault = fault_of_bins(job); !fault.empty())
      return invalid_input("--transient: {}", fault);
  }
  if (!o.reference.empty()) job.reference = std::filesystem::absolute(o.reference).lexically_normal();
  return job;
}

void add_output_options(CLI::App& app, OutputOptions& o) {
  app.add_option("--out", o.out,
                 "Folder for the images, run.json, report.html (default ./penumbra-out/<scene>)")
      ->type_name("DIR")
      ->check([](const std::string& folder) { return folder.empty() ? "names no folder" : ""; });
  app.add_flag("--json", o.json, "Standard output is exactly run.json");
  app.add_flag("--quiet", o.quiet, "Nothing but errors");
}

std::string default_folder(const std::string& scene) {
  return std::filesystem::path("penumbra-out") / std::filesystem::path(scene).stem();
}

}  // namespace penumbra

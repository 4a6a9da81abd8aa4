#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "client/commands.h"
#include "client/effect_costs.h"
#include "client/job_json.h"
#include "client/parse_text.h"
#include "client/progress.h"
#include "client/run_job.h"
#include "client/run_json.h"
#include "client/scene_defaults.h"
#include "client/submission.h"
#include "proto/status.h"
#include "scenes/curve.h"
#include "scenes/hair_params.h"
#include "scenes/mesh.h"
#include "scenes/needs.h"
#include "scenes/parser.h"
#include "scenes/substitutes.h"

namespace penumbra {
namespace {

constexpr int64_t kMostRounds = 1000;

struct InspectOptions {
  std::string scene;
  bool json = false, costs = false, quiet = false;
  std::string rounds = "3";
  JobOptions job;  ///< of the passes that are timed
  ClusterOptions cluster;
};

/// What a scene holds. Lights: those of the text that are rendered; of area lights one for each quad, sphere,
/// disk and cylinder, and one for each triangle of a mesh, because that is what is sampled. Triangles: as
/// stored, those of an instanced object once.
struct Counts {
  int64_t lights = 0, triangles = 0, materials = 0, shapes = 0, instances = 0, curves = 0;
};

bool is_one_light(const std::string& type) {
  constexpr std::array<std::string_view, 5> kWhole = {"quad", "rectangle", "sphere", "disk", "cylinder"};
  return std::find(kWhole.begin(), kWhole.end(), type) != kWhole.end();
}

absl::Status count_shape(const ShapeEntity& shape, const SceneDescription& scene, const SceneFiles& files,
                         Counts& counts, std::vector<std::string>& warnings) {
  ++counts.shapes;
  int64_t triangles = 0;
  if (shape.type == "curve") {
    ++counts.curves;
    std::vector<std::string> said;  // by each of thousands of strands
    RETURN_IF_ERROR(curve_of(shape, scene, files, said).status());
  }
  if (has_mesh(shape)) {
    ASSIGN_OR_RETURN(const TriangleMesh mesh, make_mesh(shape, scene, files, warnings));
    triangles = static_cast<int64_t>(mesh.triangles());
  }
  counts.triangles += triangles;
  if (shape.area_light >= 0) counts.lights += is_one_light(shape.type) ? 1 : triangles;
  return absl::OkStatus();
}

absl::StatusOr<Counts> count(const SceneDescription& scene, const SceneFiles& files,
                             std::vector<std::string>& warnings) {
  Counts counts;
  counts.lights = std::count_if(scene.lights.begin(), scene.lights.end(), is_rendered);
  counts.materials = static_cast<int64_t>(scene.materials.size());
  counts.instances = static_cast<int64_t>(scene.instances.size());
  for (const ShapeEntity& shape : scene.shapes)
    RETURN_IF_ERROR(count_shape(shape, scene, files, counts, warnings));
  for (const ObjectEntity& object : scene.objects)
    for (const ShapeEntity& shape : object.shapes)
      RETURN_IF_ERROR(count_shape(shape, scene, files, counts, warnings));
  return counts;
}

struct Inspection {
  SceneDefaults defaults;
  Counts counts;
  std::vector<Need> needs;
  std::vector<std::string> warnings;
  std::vector<EffectCost> costs;  ///< of the needs, in their order; none unless asked for
};

absl::StatusOr<Inspection> inspect(const std::string& path) {
  ASSIGN_OR_RETURN(const SceneDescription scene, parse_scene_file(path));
  Inspection out;
  ASSIGN_OR_RETURN(out.defaults, scene_defaults(scene));
  out.warnings = warnings_of(scene, out.defaults);
  for (const MaterialEntity& material : scene.materials) RETURN_IF_ERROR(check_hair(material, scene));
  const FolderFiles files(std::filesystem::path(path).parent_path());
  for (std::string& warning : substitutes(scene, files)) out.warnings.push_back(std::move(warning));
  ASSIGN_OR_RETURN(out.counts, count(scene, files, out.warnings));
  out.needs = needs_of(scene);
  return out;
}

absl::Status add_costs(InspectOptions& o, Inspection& inspection, std::stop_token stop) {
  o.job.scene = o.scene;
  if (o.job.mixes.empty()) o.job.mixes = {"bsdf:1+sa:1"};
  ASSIGN_OR_RETURN(const int64_t rounds, parse_whole("--rounds", o.rounds, 1, kMostRounds));
  ASSIGN_OR_RETURN(const Submission submission, prepare(o.job));
  Progress progress(Progress::style_for(o.quiet));
  std::vector<std::string> effects;
  for (const Need& need : inspection.needs) effects.push_back(need.effect);
  progress.note(fmt::format("{} runs of {} of CPU time: with everything and without each effect, {} times",
                            rounds * static_cast<int64_t>(effects.size() + 1), o.job.budget, rounds));
  ASSIGN_OR_RETURN(const std::unique_ptr<Backend> backend, open_backend({}, o.cluster));
  RETURN_IF_ERROR(backend->server->upload(submission.bundle, stop));
  ASSIGN_OR_RETURN(inspection.costs, measure_effects(*backend->server, submission.spec, effects, rounds, stop,
                                                     [&](const JobStatus&) { return backend->tend(); }));
  return absl::OkStatus();
}

Json cost_json(const EffectCost& cost) {
  return {{"pass_ratio", cost.ratio},
          {"pass_ratio_range", Json::array({cost.least, cost.most})},
          {"pass_cpu_seconds", cost.pass_seconds},
          {"pass_cpu_seconds_without", cost.pass_seconds_without},
          {"load_seconds", cost.load_seconds},
          {"load_seconds_without", cost.load_seconds_without}};
}

std::string cost_text(const EffectCost& cost) {
  return fmt::format(
      "  {:12}a pass takes {:.3g} CPU s, {:.3g} without it: {:.3f} times ({:.3f} to {:.3f}); loading "
      "{:.3g} s, {:.3g} without\n",
      "", cost.pass_seconds, cost.pass_seconds_without, cost.ratio, cost.least, cost.most, cost.load_seconds,
      cost.load_seconds_without);
}

Json inspection_json(const Inspection& i) {
  Json needs = Json::array();
  for (size_t n = 0; n < i.needs.size(); ++n) {
    needs.push_back({{"effect", i.needs[n].effect}, {"why", i.needs[n].why}});
    if (!i.costs.empty()) needs.back()["cost"] = cost_json(i.costs[n]);
  }
  return {{"needs", needs},
          {"resolution", Json::array({i.defaults.width, i.defaults.height})},
          {"lights", i.counts.lights},
          {"triangles", i.counts.triangles},
          {"materials", i.counts.materials},
          {"warnings", i.warnings},
          {"shapes", i.counts.shapes},
          {"instances", i.counts.instances},
          {"curves", i.counts.curves},
          {"samples", i.defaults.passes},
          {"max_depth", i.defaults.max_depth},
          {"mix", i.defaults.mix ? Json(label(*i.defaults.mix)) : Json(nullptr)}};
}

std::string inspection_text(const Inspection& i) {
  std::string text = fmt::format("resolution   {} x {}, {} samples per pixel, depth {}\n", i.defaults.width,
                                 i.defaults.height, i.defaults.passes, i.defaults.max_depth);
  text += fmt::format("lights       {}\ntriangles    {}\nmaterials    {}\nshapes       {}, {} instances\n",
                      i.counts.lights, i.counts.triangles, i.counts.materials, i.counts.shapes,
                      i.counts.instances);
  if (i.counts.curves > 0) text += fmt::format("curves       {}\n", i.counts.curves);
  if (i.defaults.mix) text += fmt::format("mix          {}\n", label(*i.defaults.mix));
  text += i.needs.empty() ? "needs        nothing beyond surfaces and lights\n" : "needs\n";
  for (size_t n = 0; n < i.needs.size(); ++n) {
    text += fmt::format("  {:12}{}\n", i.needs[n].effect, i.needs[n].why);
    if (!i.costs.empty()) text += cost_text(i.costs[n]);
  }
  for (const std::string& warning : i.warnings) text += fmt::format("warning: {}\n", warning);
  return text;
}

}  // namespace

void add_inspect(CLI::App& app, Chosen& chosen) {
  CLI::App* command =
      app.add_subcommand("inspect", "What a scene calls for and holds; with --costs, what it costs");
  auto options = std::make_shared<InspectOptions>();
  command->add_option("scene", options->scene)->required()->type_name("SCENE.pbrt");
  command->add_flag("--json", options->json, "As JSON");
  command->add_flag(
      "--costs", options->costs,
      "Render the scene with and without each effect that it calls for, and say what each costs");
  options->job.budget = "1s";
  const auto with_costs = [command](const char* flag, std::string& value, const char* what) {
    command->add_option(flag, value, what)->needs(command->get_option("--costs"));
  };
  with_costs("--budget", options->job.budget, "CPU seconds of each run (default 1s)");
  with_costs("--rounds", options->rounds, "How often each is run (default 3)");
  with_costs("--resolution", options->job.resolution, "WxH of the pictures (default: the scene's)");
  command->add_option("--mix", options->job.mixes, "What is rendered (default bsdf:1+sa:1)")
      ->expected(1)
      ->needs(command->get_option("--costs"));
  command->add_flag("--quiet", options->quiet, "No progress");
  add_cluster_options(*command, options->cluster);
  for (const char* flag : {"--workers", "--threads"})
    command->get_option(flag)->needs(command->get_option("--costs"));
  command->callback([options, &chosen] {
    chosen.run = [options](std::stop_token stop) {
      absl::StatusOr<Inspection> inspection = inspect(options->scene);
      if (!inspection.ok()) return tell(inspection.status());
      if (options->costs && !inspection->needs.empty())
        if (const absl::Status status = add_costs(*options, *inspection, stop); !status.ok())
          return tell(status);
      fmt::print("{}",
                 options->json ? json_text(inspection_json(*inspection)) : inspection_text(*inspection));
      return 0;
    };
  });
}

}  // namespace penumbra

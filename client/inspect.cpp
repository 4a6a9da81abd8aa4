#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "client/commands.h"
#include "client/job_json.h"
#include "client/run_json.h"
#include "client/scene_defaults.h"
#include "client/submission.h"
#include "proto/status.h"
#include "scenes/mesh.h"
#include "scenes/needs.h"
#include "scenes/parser.h"

namespace penumbra {
namespace {

struct InspectOptions {
  std::string scene;
  bool json = false;
};

/// What a scene holds. Lights: every light of the text; of area lights one for each quad, sphere, disk and
/// cylinder, and one for each triangle of a mesh, because that is what is sampled. Triangles: as stored,
/// those of an instanced object once.
struct Counts {
  int64_t lights = 0, triangles = 0, materials = 0, shapes = 0, instances = 0;
};

bool is_one_light(const std::string& type) {
  constexpr std::array<std::string_view, 5> kWhole = {"quad", "rectangle", "sphere", "disk", "cylinder"};
  return std::find(kWhole.begin(), kWhole.end(), type) != kWhole.end();
}

absl::Status count_shape(const ShapeEntity& shape, const SceneDescription& scene, const SceneFiles& files,
                         Counts& counts, std::vector<std::string>& warnings) {
  ++counts.shapes;
  int64_t triangles = 0;
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
  counts.lights = static_cast<int64_t>(scene.lights.size());
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
};

absl::StatusOr<Inspection> inspect(const std::string& path) {
  ASSIGN_OR_RETURN(const SceneDescription scene, parse_scene_file(path));
  Inspection out;
  ASSIGN_OR_RETURN(out.defaults, scene_defaults(scene));
  out.warnings = warnings_of(scene, out.defaults);
  const FolderFiles files(std::filesystem::path(path).parent_path());
  ASSIGN_OR_RETURN(out.counts, count(scene, files, out.warnings));
  out.needs = needs_of(scene);
  return out;
}

Json inspection_json(const Inspection& i) {
  Json needs = Json::array();
  for (const Need& need : i.needs) needs.push_back({{"effect", need.effect}, {"why", need.why}});
  return {{"needs", needs},
          {"resolution", Json::array({i.defaults.width, i.defaults.height})},
          {"lights", i.counts.lights},
          {"triangles", i.counts.triangles},
          {"materials", i.counts.materials},
          {"warnings", i.warnings},
          {"shapes", i.counts.shapes},
          {"instances", i.counts.instances},
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
  if (i.defaults.mix) text += fmt::format("mix          {}\n", label(*i.defaults.mix));
  text += i.needs.empty() ? "needs        nothing beyond surfaces and lights\n" : "needs\n";
  for (const Need& need : i.needs) text += fmt::format("  {:11}{}\n", need.effect, need.why);
  for (const std::string& warning : i.warnings) text += fmt::format("warning: {}\n", warning);
  return text;
}

}  // namespace

void add_inspect(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand("inspect", "What a scene calls for and holds; nothing is rendered");
  auto options = std::make_shared<InspectOptions>();
  command->add_option("scene", options->scene)->required()->type_name("SCENE.pbrt");
  command->add_flag("--json", options->json, "As JSON");
  command->callback([options, &chosen] {
    chosen.run = [options](std::stop_token) {
      const absl::StatusOr<Inspection> inspection = inspect(options->scene);
      if (!inspection.ok()) return tell(inspection.status());
      fmt::print("{}",
                 options->json ? json_text(inspection_json(*inspection)) : inspection_text(*inspection));
      return 0;
    };
  });
}

}  // namespace penumbra

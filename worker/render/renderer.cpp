#include "worker/render/renderer.h"

#include <fmt/format.h>

#include <chrono>
#include <map>
#include <set>

#include "proto/status.h"
#include "scenes/leave_out.h"
#include "scenes/needs.h"
#include "scenes/parser.h"
#include "scenes/standing.h"
#include "worker/render/camera.h"
#include "worker/render/render_space.h"
#include "worker/render/scene_builder.h"
#include "worker/strategies/strategy.h"

namespace penumbra {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

const char* shape_name(const LightShape& shape) {
  struct Name {
    const char* operator()(const QuadShape& q) const { return q.rectangle() ? "rectangle" : "parallelogram"; }
    const char* operator()(const TriangleShape&) const { return "triangle"; }
    const char* operator()(const SphereShape&) const { return "sphere"; }
    const char* operator()(const DiskShape&) const { return "disk"; }
    const char* operator()(const CylinderShape&) const { return "cylinder"; }
  };
  return std::visit(Name{}, shape);
}

}  // namespace

void SceneDeleter::operator()(Scene* scene) const {
  delete scene;
}

absl::StatusOr<ScenePtr> load_scene(const std::string& main_name, const SceneFiles& files,
                                    const LoadOptions& options, LoadReport& report) {
  const auto start = std::chrono::steady_clock::now();
  ASSIGN_OR_RETURN(SceneDescription description, parse_scene(main_name, files));
  for (const std::string& effect : options.leave_out) RETURN_IF_ERROR(leave_out(effect, description));
  report.parse_seconds = seconds_since(start);
  return build_scene(description, files, options, report);
}

absl::StatusOr<ScenePtr> build_scene(const SceneDescription& description, const SceneFiles& files,
                                     const LoadOptions& options, LoadReport& report) {
  const auto start = std::chrono::steady_clock::now();
  report.needs = needs_of(description);
  report.warnings = description.warnings;
  for (std::string& warning : unsupported(description)) report.warnings.push_back(std::move(warning));
  ASSIGN_OR_RETURN(const std::optional<Vec3d> origin, distant_origin(description, files));
  const SceneDescription near = origin ? moved_to(*origin, description) : SceneDescription();
  const SceneDescription& placed = origin ? near : description;
  RETURN_IF_ERROR(Camera::build(placed, 1, 1).status());
  ASSIGN_OR_RETURN(Effects effects, build_effects(placed));
  SceneDescription still;
  const bool moves = anything_moves(placed);
  if (moves) {
    ASSIGN_OR_RETURN(still, standing(placed, effects.motion));
  }
  RenderSceneBuilder builder(moves ? still : placed, std::move(effects), files, options, report.warnings);
  ASSIGN_OR_RETURN(ScenePtr scene, builder.build());
  if (options.strict && !report.warnings.empty())
    return invalid_input("--strict: {}", report.warnings.front());
  report.build_seconds = seconds_since(start);
  return scene;
}

std::vector<std::string> substitutions(const Scene& scene, const Mix& mix) {
  // (wanted, shape, instead) -> how many lights.
  std::map<std::tuple<std::string, std::string, std::string>, int> counts;
  for (const StrategyCount& wanted : mix.strategies) {
    const Mix alone{false, {{wanted.kind, wanted.angle_degrees, 1}}};
    std::string name = label(alone);
    name.resize(name.find(':'));
    for (const AreaEmitter& emitter : scene.lights.area) {
      const std::string instead = name_of(fit(in_company(wanted, mix), emitter));
      if (instead != name) ++counts[{name, shape_name(emitter.shape), instead}];
    }
  }
  std::vector<std::string> out;
  if (mix.medium == MediumSampling::kLine && !scene.effects.media)
    out.push_back("medium=line without media: nothing to do");
  if (mix.lens == LensSampling::kLine && !scene.effects.lens)
    out.push_back("lens=line on a pinhole: nothing to do");
  if (mix.motion == MotionSampling::kLine && !scene.effects.motion)
    out.push_back("motion=line where nothing moves: nothing to do");
  else if (mix.motion == MotionSampling::kLine && mix.lens == LensSampling::kLine && scene.effects.lens)
    out.push_back("motion=line beside lens=line: chords of the lens, at points in time");
  if (mix.pixel == PixelSampling::kLine && (scene.effects.lens || scene.effects.motion))
    out.push_back("pixel=line where there is a lens or something moves: points of the film");
  for (const auto& [key, n] : counts)
    out.push_back(fmt::format("{} on {} {} light{}: {}", std::get<0>(key), n, std::get<1>(key),
                              n == 1 ? "" : "s", std::get<2>(key)));
  return out;
}

SceneCounts counts(const Scene& scene) {
  return {int64_t(scene.lights.size()), scene.triangles, int64_t(scene.description.materials.size())};
}

}  // namespace penumbra

#pragma once
// What the agent (and the tests) ask of the renderer: load a scene, render a tile task.
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "film/tile_pixels.h"
#include "proto/job.h"
#include "scenes/description.h"
#include "scenes/files.h"

namespace penumbra {

/// A scene ready to be rendered: immutable, shared by the threads of a worker.
class Scene;

struct SceneDeleter {
  void operator()(Scene*) const;
};
using ScenePtr = std::unique_ptr<Scene, SceneDeleter>;

struct LoadOptions {
  int threads = 1;
  bool strict = false;
  std::vector<std::string> leave_out = {};  ///< effects of the scene that are not to be rendered
};

/// Parses and builds. InvalidArgument (`file:line:column: …`) is the scene's fault.
absl::StatusOr<ScenePtr> load_scene(const std::string& main_name, const SceneFiles& files,
                                    const LoadOptions& options, LoadReport& report);
absl::StatusOr<ScenePtr> build_scene(const SceneDescription& description, const SceneFiles& files,
                                     const LoadOptions& options, LoadReport& report);

struct TaskOutcome {
  TileResult pixels;           ///< empty for a pilot
  std::vector<MixCost> costs;  ///< one per mix; of a pilot, then one per candidate in task.chosen
  bool cancelled = false;      ///< then nothing else is valid
};

/// Renders a tile task on the calling thread: the mixes' passes in slices, interleaved in an order
/// drawn from task.shuffle. Clock: CLOCK_THREAD_CPUTIME_ID, read once per tile pass.
TaskOutcome render_tile(const Scene& scene, const JobSpec& job, const TileTask& task,
                        const std::atomic<bool>& cancel);

/// Strategies of the mix that some light of the scene cannot serve, and what is used instead
/// (`line-sa@v on 2 triangle lights: sa`), and lines on a lens that the camera has not. Empty: the mix fits.
std::vector<std::string> substitutions(const Scene& scene, const Mix& mix);

/// What `inspect` counts.
struct SceneCounts {
  int64_t lights = 0, triangles = 0, materials = 0;
};
SceneCounts counts(const Scene& scene);

}  // namespace penumbra

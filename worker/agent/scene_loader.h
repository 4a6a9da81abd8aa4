#pragma once
// What the agent asks of the renderer, as an interface: its tests render with a fake.
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "worker/render/renderer.h"

namespace penumbra {

/// A scene ready to be rendered by several threads at once.
class RenderableScene {
 public:
  virtual ~RenderableScene() = default;
  /// Renders on the calling thread.
  virtual TaskOutcome render(const JobSpec& job, const TileTask& task,
                             const std::atomic<bool>& cancel) const = 0;
  /// Strategies of the mix that do not fit a light of the scene, and what is used instead.
  virtual std::vector<std::string> substitutions(const Mix& mix) const = 0;
};

class SceneLoader {
 public:
  virtual ~SceneLoader() = default;
  /// InvalidArgument (`file:line:column: …`) is the scene's fault; anything else the worker's.
  virtual absl::StatusOr<std::shared_ptr<const RenderableScene>> load(const std::string& main_name,
                                                                      const SceneFiles& files,
                                                                      const LoadOptions& options,
                                                                      LoadReport& report) const = 0;
};

}  // namespace penumbra

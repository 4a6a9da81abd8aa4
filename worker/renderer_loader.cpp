#include "worker/renderer_loader.h"

#include "proto/status.h"

namespace penumbra {
namespace {

class RendererScene final : public RenderableScene {
 public:
  explicit RendererScene(ScenePtr scene) : scene_(std::move(scene)) {}
  TaskOutcome render(const JobSpec& job, const TileTask& task,
                     const std::atomic<bool>& cancel) const override {
    return render_tile(*scene_, job, task, cancel);
  }
  std::vector<std::string> substitutions(const Mix& mix) const override {
    return penumbra::substitutions(*scene_, mix);
  }

 private:
  ScenePtr scene_;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const RenderableScene>> RendererLoader::load(const std::string& main_name,
                                                                            const SceneFiles& files,
                                                                            const LoadOptions& options,
                                                                            LoadReport& report) const {
  ASSIGN_OR_RETURN(ScenePtr scene, load_scene(main_name, files, options, report));
  return std::make_shared<RendererScene>(std::move(scene));
}

}  // namespace penumbra

#pragma once
#include "worker/agent/scene_loader.h"

namespace penumbra {

/// The agent's interface over worker/render.
class RendererLoader final : public SceneLoader {
 public:
  absl::StatusOr<std::shared_ptr<const RenderableScene>> load(const std::string& main_name,
                                                              const SceneFiles& files,
                                                              const LoadOptions& options,
                                                              LoadReport& report) const override;
};

}  // namespace penumbra

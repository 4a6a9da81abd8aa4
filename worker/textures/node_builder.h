#pragma once
// From a texture's parameters to its node.
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "worker/textures/image_file.h"
#include "worker/textures/nodes.h"

namespace penumbra {

/// Builds the nodes of one scene; images that several textures share are read once.
class NodeBuilder {
 public:
  NodeBuilder(const SceneDescription& description, const SceneFiles& files, bool strict,
              std::vector<std::string>& warnings)
      : description_(description), files_(files), strict_(strict), warnings_(warnings) {}

  absl::StatusOr<Node> build(const TextureEntity& entity);

 private:
  absl::StatusOr<Node> build_image(const TextureEntity& entity);
  absl::StatusOr<Node> build_checkerboard(const TextureEntity& entity);
  absl::StatusOr<Node> build_noise(const TextureEntity& entity);
  absl::StatusOr<Node> build_with_mapping(const TextureEntity& entity);
  absl::StatusOr<std::shared_ptr<const Image>> image(const std::string& path, bool grey,
                                                     const Encoding& encoding);
  absl::StatusOr<RgbValue> value(const TextureEntity& entity, std::string_view name, float fallback) const;
  /// With strict the message as an error, else a warning and OK.
  absl::Status complain(std::string message);
  std::string place(const Entity& entity) const { return description_.place(entity.loc); }

  const SceneDescription& description_;
  const SceneFiles& files_;
  bool strict_;
  std::vector<std::string>& warnings_;
  using ImageKey = std::tuple<std::string, bool, int, float>;
  std::map<ImageKey, std::shared_ptr<const Image>> images_;
};

}  // namespace penumbra

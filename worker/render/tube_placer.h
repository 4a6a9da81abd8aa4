#pragma once
// Curves that are tubes, gathered while shapes are placed: a million strands are a million shapes, but one
// mesh for each material.
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "scenes/files.h"
#include "worker/render/scene.h"

namespace penumbra {

class TubePlacer {
 public:
  /// `scene` is asked for its materials when a curve is added.
  TubePlacer(const SceneDescription& description, const SceneFiles& files, const ScenePtr& scene,
             std::vector<std::string>& warnings)
      : description_(description), files_(files), scene_(scene), warnings_(warnings) {}

  /// Instances of objects are placed as often as they occur: tubes are in the world.
  absl::Status add(const ShapeEntity& shape, const Matrix& to_world);

  struct Placed {
    SceneMesh mesh;
    const ShapeEntity* shape;  ///< the first of those it was made from
  };
  /// Everything added, once.
  std::vector<Placed> finish();

 private:
  struct Group {
    Tubes tubes;
    const ShapeEntity* shape = nullptr;
  };
  /// Says it for the first shape that it is true of.
  void warn_once(const char* what, const ShapeEntity& shape);

  const SceneDescription& description_;
  const SceneFiles& files_;
  const ScenePtr& scene_;
  std::vector<std::string>& warnings_;
  std::map<std::pair<int, bool>, Group> groups_;  ///< by material, and whether they face the viewer
  std::vector<std::string> said_;
};

}  // namespace penumbra

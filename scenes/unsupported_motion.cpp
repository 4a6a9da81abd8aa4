#include "scenes/unsupported_motion.h"

#include <algorithm>

#include "proto/status.h"
#include "scenes/animated_transform.h"
#include "scenes/curve.h"
#include "scenes/standing.h"

namespace penumbra {
namespace {

/// How many of a kind, and where the first is.
struct Standing {
  const char* what;
  const char* how = "as when the shutter opens";
  int count = 0;
  FileLoc first;
  void add(FileLoc loc) {
    if (count++ == 0) first = loc;
  }
};

}  // namespace

void add_unsupported_motion(const SceneDescription& scene, std::vector<std::string>& out) {
  const Shutter shutter = shutter_of(scene);
  if (!(shutter.open < shutter.close)) return;
  Standing boundaries{"a boundary of a medium"}, curves{"a curve"}, inner{"a shape inside an object"};
  Standing others{"a light", "at its first transform, as in pbrt"};
  for (const ShapeEntity& shape : scene.shapes) {
    if (!shape.placement.moving() || can_move(shape)) continue;
    (has_tubes(shape) ? curves : boundaries).add(shape.loc);
  }
  for (const InstanceEntity& instance : scene.instances) {
    if (!instance.placement.moving() || instance.object < 0 || can_move(instance, scene)) continue;
    const std::vector<ShapeEntity>& shapes = scene.objects[static_cast<size_t>(instance.object)].shapes;
    (std::any_of(shapes.begin(), shapes.end(), has_tubes) ? curves : boundaries).add(instance.loc);
  }
  for (const ObjectEntity& object : scene.objects)
    for (const ShapeEntity& shape : object.shapes)
      if (shape.placement.moving()) inner.add(shape.loc);
  for (const LightEntity& light : scene.lights)
    if (light.placement.moving()) others.add(light.loc);
  for (const Standing& kind : {boundaries, curves, inner, others})
    if (kind.count > 0)
      out.push_back(fmt::format("{}: motion of {} is not supported: {} stand{} {}", scene.place(kind.first),
                                kind.what, kind.count, kind.count == 1 ? "s" : "", kind.how));
}

}  // namespace penumbra

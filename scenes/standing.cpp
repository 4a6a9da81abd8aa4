#include "scenes/standing.h"

#include <algorithm>

#include "proto/status.h"
#include "scenes/animated_transform.h"
#include "scenes/curve.h"
#include "scenes/each_shape.h"

namespace penumbra {
namespace {

bool bounds_a_medium(const ShapeEntity& shape) {
  return !shape.inside_medium.empty() || !shape.outside_medium.empty();
}

/// Where something is when the shutter opens; `what` and `loc` for the message.
absl::StatusOr<Matrix> at_opening(const Matrix& start, const Matrix& end, const SceneDescription& description,
                                  std::string_view what, FileLoc loc) {
  const auto motion = AnimatedTransform::between(start, end, shutter_of(description));
  if (!motion)
    return invalid_input("{}: this {} moves from a placement that mirrors to one that does not",
                         description.place(loc), what);
  return motion->at(0);
}

/// Puts it where it is when the shutter opens, if it moves and is not to go on moving.
absl::Status stand(Placement& placement, bool goes_on, const SceneDescription& description,
                   std::string_view what, FileLoc loc) {
  if (!placement.moving()) return absl::OkStatus();
  ASSIGN_OR_RETURN(const Matrix open, at_opening(placement.start, placement.end, description, what, loc));
  if (!goes_on) placement.start = placement.end = open;
  return absl::OkStatus();
}

}  // namespace

bool anything_moves(const SceneDescription& description) {
  bool moves = description.camera_placement.moving() ||
               std::any_of(description.instances.begin(), description.instances.end(),
                           [](const InstanceEntity& i) { return i.placement.moving(); });
  each_shape(description, [&](const ShapeEntity& shape) { moves |= shape.placement.moving(); });
  return moves;
}

bool can_move(const ShapeEntity& shape) {
  return !bounds_a_medium(shape) && !has_tubes(shape);
}

bool can_move(const InstanceEntity& instance, const SceneDescription& description) {
  if (instance.object < 0) return false;
  const auto& shapes = description.objects[static_cast<size_t>(instance.object)].shapes;
  return std::none_of(shapes.begin(), shapes.end(),
                      [](const ShapeEntity& shape) { return bounds_a_medium(shape) || has_tubes(shape); });
}

absl::StatusOr<SceneDescription> standing(const SceneDescription& description, bool movers) {
  SceneDescription still = description;
  Placement& camera = still.camera_placement;
  if (camera.moving()) {
    // pbrt interpolates from camera to world.
    ASSIGN_OR_RETURN(const Matrix open, at_opening(camera.start.inverse(), camera.end.inverse(), description,
                                                   "camera", still.camera.loc));
    camera.start = camera.end = open.inverse();
  }
  for (ShapeEntity& shape : still.shapes)
    RETURN_IF_ERROR(stand(shape.placement, movers && can_move(shape), description, shape.type, shape.loc));
  for (ObjectEntity& object : still.objects)
    for (ShapeEntity& shape : object.shapes)
      RETURN_IF_ERROR(stand(shape.placement, false, description, shape.type, shape.loc));
  for (InstanceEntity& instance : still.instances)
    RETURN_IF_ERROR(stand(instance.placement, movers && can_move(instance, description), description,
                          "instance", instance.loc));
  return still;
}

}  // namespace penumbra

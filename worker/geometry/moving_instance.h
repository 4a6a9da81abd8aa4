#pragma once
// An instance that moves, for Embree: a geometry of ours whose rays are carried into the object at their own
// time. Embree's own moving instances interpolate in single precision with approximate sines; these stand
// where line queries and shading have them, to a rounding.
#include <memory>
#include <vector>

#include "scenes/animated_transform.h"
#include "worker/geometry/embree.h"

namespace penumbra {

/// What Embree calls back with; must outlive the geometry.
struct MovingInstance {
  RTCScene object = nullptr;
  std::shared_ptr<const AnimatedTransform> motion;
  std::vector<MovedBox> boxes;
};

/// A committed geometry; hits carry its geometry number as instID[0]. The object is
/// committed and not empty.
GeometryHandle make_moving_instance(RTCDevice device, MovingInstance& instance);

}  // namespace penumbra

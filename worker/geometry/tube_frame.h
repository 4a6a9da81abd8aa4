#pragma once
// A segment's axis and two directions across it.
#include "worker/sampling/warp.h"

namespace penumbra {

struct TubeFrame {
  explicit TubeFrame(const Vec3d& e) : length(e.length()), axis(length > 0 ? e / length : Vec3d(0, 0, 1)) {
    frame(axis, s, t);
  }
  double length;
  Vec3d axis, s, t;
};

}  // namespace penumbra

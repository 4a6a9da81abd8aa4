#include "worker/geometry/pose.h"

#include <vector>

namespace penumbra {
namespace {

/// A pose and whose it is.
struct Kept {
  uint64_t motion = 0;  ///< AnimatedTransform::id(), which is never 0
  float time = 0;
  Pose pose;
};

/// More movers than that share places; answers are the same.
constexpr size_t kPlaces = 256;

}  // namespace

const Pose& pose_at(const AnimatedTransform& motion, float time) {
  thread_local std::vector<Kept> places(kPlaces);
  Kept& kept = places[motion.id() % kPlaces];
  if (kept.motion == motion.id() && kept.time == time) return kept.pose;
  kept.motion = motion.id();
  kept.time = time;
  Pose& pose = kept.pose;
  pose.to_world = motion.at(double{time});
  pose.to_object = pose.to_world.inverse();
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) pose.normals[i][k] = pose.to_object[k][i];
  return pose;
}

}  // namespace penumbra

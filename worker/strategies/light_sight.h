#pragma once
// What a shading point sees of one flat light before any sample is drawn: the shaft (geometry/shaft.h), asked
// where it pays. That changes no image: what it answers for lines and points is what they would find alone. Where a
// strategy asks for it, also what of the light is visible.
#include <optional>
#include <vector>

#include "worker/geometry/shaft.h"
#include "worker/lights/emitter.h"
#include "worker/lights/visible_region.h"
#include "worker/strategies/shading_point.h"

namespace penumbra {

/// The polygon of a light that is traced as what it is; nothing for curved ones.
std::optional<LightPolygon> polygon_of(const AreaEmitter& emitter);

/// What a mix asks of one light at one shading point.
struct VisibilityWork {
  int lines = 0;  ///< of the strategies themselves
  int rays = 0;   ///< shadow rays
  bool region = false;  ///< whether a strategy samples what is visible of the light
};

/// Belongs to one thread; keeps memory from light to light.
class LightSight {
 public:
  /// Looks from the point at its `index`-th area light. False: no sample of it can reach the point.
  bool look(const Geometry& geometry, const ShadingPoint& point, const AreaEmitter& emitter, size_t index,
            const VisibilityWork& work, QueryCounters& counters);
  /// Without a look: no shaft.
  void skip() { entered_ = false, region_known_ = false; }
  /// What is visible of the light last looked at; null: not asked for, or not known.
  const VisibleRegion* region() const { return region_known_ ? &region_ : nullptr; }
  /// For what starts above the surface towards the light last looked at; null: ask for each line and ray.
  const Shaft* for_lines() const { return entered_ ? &shaft_ : nullptr; }
  const Shaft* for_rays(const Vec3f& origin) const {
    return entered_ && rays_ && origin == x_ ? &shaft_ : nullptr;
  }

 private:
  /// One light: its polygon, and how often of late its shafts held too much to list.
  struct Light {
    bool known = false;
    std::optional<LightPolygon> polygon;
    int failures = 0, pause = 0;
  };
  static bool worth(Light& light, const VisibilityWork& work);
  /// Finds the region; false: it is not known.
  bool find_region(const ShadingPoint& point, const AreaEmitter& emitter, const LightPolygon& polygon,
                   QueryCounters& counters);

  std::vector<Light> lights_;
  Shaft shaft_;
  Vec3f x_{0};  ///< where it starts
  bool entered_ = false, rays_ = false;
  VisibleRegion region_;
  bool region_known_ = false;
};

}  // namespace penumbra

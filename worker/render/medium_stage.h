#pragma once
// Where participating media take part in a camera path. Chosen once at load (worker/effects/effects.h): a
// scene without media has no stage, and pays one test of a null pointer per segment of a path.
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "worker/geometry/geometry.h"
#include "worker/materials/scattering.h"
#include "worker/sampling/sampler.h"
#include "worker/strategies/attenuation.h"

namespace penumbra {

/// A point of a medium that is to be lit: what is scattered there towards the ray's origin counts `weight`.
struct ScatterVertex {
  Vec3f p;
  const Scattering* phase = nullptr;
  Rgb weight{0};        ///< attenuation on the way to the ray's origin × scattering / density of the point
  PassSampler sampler;  ///< for what happens at the point
  int medium = 0;
};

/// What points of a segment are drawn with.
struct ScatterDraw {
  const PassSampler& sampler;
  int depth = 0;
  std::optional<Vec3d> pivot;  ///< a place that light comes from; some points are drawn with it in mind
  double from = 0, until = std::numeric_limits<double>::infinity();  ///< only within these distances
};

/// A part of the last pass() that lay in a medium that scatters.
struct MediumPart {
  double t0 = 0, t1 = 0;
  const Scattering* phase = nullptr;
  int medium = 0;
};

/// One path on its way through the media of a scene; belongs to one thread. It stands in one medium, or on a
/// surface with one on either side: there transmittance() begins.
class MediumWalk : public Attenuation {
 public:
  /// At the camera.
  virtual void start() = 0;
  /// Along a ray with unit direction from where the walk stands to a surface at `distance`; infinite: no
  /// surface. Returns the share of light that passes all of it. `draw`: appends points of it to be lit; null:
  /// none.
  virtual Rgb pass(const Ray& ray, double distance, const ScatterDraw* draw,
                   std::vector<ScatterVertex>& out) = 0;
  virtual std::span<const MediumPart> parts() const = 0;
  /// Scattering coefficient at t of a part × attenuation on the way to the ray's origin: what is scattered there
  /// counts so much per length.
  virtual Rgb scattering(size_t part, double t) const = 0;
  /// The walk stands in a medium that a vertex or a part has named.
  virtual void stand_in(int medium) = 0;
  /// The walk stands where the last pass() has ended, wherever it has stood since.
  virtual void arrive() = 0;
  /// There is a surface there: the scene's mesh, whose normal at the point (pbrt's orientation) is `ng`.
  virtual void stand_on(uint32_t mesh, const Vec3f& ng) = 0;
  /// It leaves that surface.
  virtual void leave(const Vec3f& direction) = 0;
};

class MediumStage {
 public:
  virtual ~MediumStage() = default;
  virtual std::unique_ptr<MediumWalk> walk() const = 0;
};

}  // namespace penumbra

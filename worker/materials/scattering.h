#pragma once
// What scatters light at a shading point: a surface's BSDF, or a medium's phase function.
#include <optional>

#include "scenes/math.h"

namespace penumbra {

struct BsdfSample {
  Vec3f wi;
  Rgb f;           ///< for specular lobes: f such that the throughput is f * |cosθ| / pdf
  double pdf = 0;  ///< sr⁻¹; for a specular lobe the discrete probability
  bool specular = false;
};

/// All directions are unit, in world space, and point away from the point.
class Scattering {
 public:
  virtual ~Scattering() = default;
  /// Scattering function × the cosine at the point (which a medium does not have), sr⁻¹.
  virtual Rgb scatter(const Vec3f& wo, const Vec3f& wi) const = 0;
  /// Density of sample() at wi, sr⁻¹. Zero where it cannot reach.
  virtual double pdf(const Vec3f& wo, const Vec3f& wi) const = 0;
  /// A direction in proportion to what is scattered; empty if the sample failed.
  virtual std::optional<BsdfSample> sample(const Vec3f& wo, const Vec2d& u, double choice) const = 0;
  /// Has it a lobe whose peak is more than kNarrowPeak times what an even one is everywhere? A few samples of
  /// a light then cannot tell how bright its rare bright ones are.
  virtual bool has_narrow_lobe() const = 0;
};

constexpr double kNarrowPeak = 10;

}  // namespace penumbra

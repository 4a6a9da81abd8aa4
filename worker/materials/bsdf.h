#pragma once
// The scattering function at one shading point: a few lobes in the shading frame. One file per lobe.
// f is per solid angle and does not contain the cosine; all directions are unit, in world space, and
// point away from the surface. pbrt-v3's conventions (geometric normal decides reflect or transmit).
#include <array>
#include <optional>
#include <variant>

#include "scenes/math.h"
#include "worker/geometry/surface_point.h"
#include "worker/materials/lobes.h"

namespace penumbra {

struct BsdfSample {
  Vec3f wi;
  Rgb f;           ///< for specular lobes: f such that the throughput is f * |cosθ| / pdf
  double pdf = 0;  ///< sr⁻¹; for a specular lobe the discrete probability
  bool specular = false;
};

class Bsdf {
 public:
  static constexpr int kMostLobes = 8;

  Bsdf(const SurfacePoint& point, const Vec3f& ns);
  /// A ninth lobe is a programmer's fault.
  void add(const Lobe& lobe);

  /// Sum of the non-specular lobes that serve this pair of directions.
  Rgb f(const Vec3f& wo, const Vec3f& wi) const;
  /// Density of sample() over the non-specular lobes at wi. Zero where it cannot reach.
  double pdf(const Vec3f& wo, const Vec3f& wi) const;
  /// A direction from the non-specular lobes; empty if there is none or the sample failed.
  std::optional<BsdfSample> sample(const Vec3f& wo, const Vec2d& u, double choice) const;
  /// The specular lobes one by one: index in [0, specular_count()).
  int specular_count() const;
  std::optional<BsdfSample> sample_specular(const Vec3f& wo, int index) const;

  bool has_non_specular() const;
  /// May light from below the geometric horizon matter? Then lines must not be clipped to it.
  bool transmits() const;
  const Vec3f& ns() const { return ns_; }

 private:
  Vec3f ng_, ns_, ss_, ts_;
  std::array<Lobe, kMostLobes> lobes_;
  int count_ = 0;
};

}  // namespace penumbra

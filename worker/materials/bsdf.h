#pragma once
// The scattering function at one shading point: a few lobes in the shading frame. One file per lobe.
// f is per solid angle and does not contain the cosine; all directions are unit, in world space, and
// point away from the surface. pbrt-v3's conventions (geometric normal decides reflect or transmit).
#include <array>
#include <cmath>
#include <optional>
#include <variant>

#include "scenes/math.h"
#include "worker/geometry/surface_point.h"
#include "worker/materials/lobes.h"
#include "worker/materials/scattering.h"

namespace penumbra {

class Bsdf final : public Scattering {
 public:
  static constexpr int kMostLobes = 8;

  Bsdf(const SurfacePoint& point, const Vec3f& ns);
  /// `scale` multiplies f (mixed materials); a black one adds nothing. A ninth lobe is a programmer's fault.
  void add(const Lobe& lobe, const Rgb& scale = Rgb(1));

  /// Sum of the non-specular lobes that serve this pair of directions.
  Rgb f(const Vec3f& wo, const Vec3f& wi) const;
  /// f × cosine.
  Rgb scatter(const Vec3f& wo, const Vec3f& wi) const override { return f(wo, wi) * std::abs(wi.dot(ns_)); }
  /// The part of f that is constant (Lambert's lobes) where light is reflected or, else, transmitted; the
  /// rest of f; whether there is no rest. For integrals in closed form.
  Rgb lambertian(bool reflected) const;
  Rgb f_beyond_lambertian(const Vec3f& wo, const Vec3f& wi) const;
  bool only_lambertian() const;
  /// Density of sample() over the non-specular lobes at wi, sr⁻¹. Zero where it cannot reach.
  double pdf(const Vec3f& wo, const Vec3f& wi) const override;
  /// A direction from the non-specular lobes; empty if there is none or the sample failed.
  std::optional<BsdfSample> sample(const Vec3f& wo, const Vec2d& u, double choice) const override;
  /// The specular lobes one by one: index in [0, specular_count()).
  int specular_count() const { return specular_; }
  std::optional<BsdfSample> sample_specular(const Vec3f& wo, int index) const;

  bool has_non_specular() const { return count_ > specular_; }
  bool has_narrow_lobe() const override { return narrow_; }
  /// May light from below the geometric horizon matter? Then lines must not be clipped to it.
  bool transmits() const { return transmits_; }
  const Vec3f& ns() const { return ns_; }

 private:
  struct Pair;
  /// One lobe of the mixture: its scale, and its share of the samples (unnormalised; 0 for specular).
  struct Weighted {
    Lobe lobe;
    Rgb scale;
    float weight = 0;
  };

  Vec3d to_local(const Vec3f& w) const;
  Vec3f to_world(const Vec3d& w) const;
  Pair pair(const Vec3f& wo, const Vec3f& wi) const;
  Rgb f(const Pair& directions) const;
  double pdf(const Pair& directions) const;
  const Weighted& choose(double& choice) const;

  Vec3f ng_, ns_, ss_, ts_;
  std::array<Weighted, kMostLobes> lobes_;
  int count_ = 0, specular_ = 0;
  float total_weight_ = 0;
  bool transmits_ = false, narrow_ = false;
};

}  // namespace penumbra

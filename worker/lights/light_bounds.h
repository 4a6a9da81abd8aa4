#pragma once
// What is known of a light, or of many, from far away: where they are, which way they shine, how much. After
// Conty Estévez & Kulla 2018, «Importance Sampling of Many Lights with Adaptive Tree Splitting».
#include "worker/lights/emitter.h"

namespace penumbra {

/// Directions within an angle of an axis; angles by their cosines, −1: all directions.
struct NormalCone {
  Vec3d axis{0, 0, 1};  ///< unit
  double cos_spread = 1;
};

/// The smallest cone that holds both, but for rounding: then it is wider.
NormalCone join(const NormalCone& a, const NormalCone& b);

struct LightBounds {
  Vec3d lo{0, 0, 0}, hi{0, 0, 0};
  NormalCone normals;
  /// Light leaves within this angle of some normal, and no other: 0 (a right angle) for surfaces.
  double cos_emission = 0;
  double power = 0;  ///< Σ luminance × area; of a point light its intensity. lm-like, W sr⁻¹
};

LightBounds join(const LightBounds& a, const LightBounds& b);

LightBounds bounds_of(const AreaEmitter& emitter);
LightBounds bounds_of(const PointEmitter& emitter);
LightBounds bounds_of(const SpotEmitter& emitter);

/// Who asks for light: the point x and, where light from below its horizon does not matter, its normal.
struct Receiver {
  Vec3d x{0, 0, 0};
  bool has_horizon = false;
  Vec3d normal{0, 0, 1};  ///< unit; if has_horizon
};

/// An estimate of the irradiance at the receiver by what is within the bounds: power × cosine at the light ×
/// cosine at the receiver / squared distance, both cosines the largest that the bounds allow, the distance
/// that of the centre, but at least the radius. 0 only if no light can arrive.
double importance(const LightBounds& bounds, const Receiver& receiver);

double luminance(const Rgb& c);

}  // namespace penumbra

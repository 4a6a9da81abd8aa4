#pragma once
// What emits: the closed set of light sources apart from the environment (worker/effects). An area
// emitter is a shape, its radiance, and the primitives that are its surface; two-sided lights are two
// emitters back to back, so that every emitter has one side.
#include <cstdint>
#include <memory>
#include <variant>

#include "scenes/math.h"
#include "worker/lights/shape.h"

namespace penumbra {

struct LightMotion;  // moving_light.h

struct AreaEmitter {
  LightShape shape;
  Rgb radiance;                  ///< W m⁻² sr⁻¹, constant over the shape
  uint32_t mesh = 0;             ///< the geometry's mesh that is this light's surface
  uint32_t first_primitive = 0;  ///< its triangles there
  uint32_t primitives = 0;
  /// The triangles are the shape itself (quad, triangle), not a tessellation of it.
  bool flat = true;
  // How it stands in the scene, if it is flat (geometry: LightPlace).
  double rounding = 0;
  bool crowded = true;
  /// Its surface is not there for rays (`"float alpha" 0`): a material's direction cannot meet it.
  bool invisible = false;
  /// It is flat and has holes where its texture of alpha is 0 (Geometry::in_hole()): no light comes from
  /// there.
  bool has_holes = false;
  /// It moves: `shape` is where it is when the shutter opens; moving_light.h says where else. Null: it
  /// stands.
  std::shared_ptr<const LightMotion> motion = nullptr;
  /// Of one that moves: the geometry's instance that carries its mesh. All ones: it is in the world.
  uint32_t instance = ~uint32_t{0};
};

/// Unit normal of the emission side at a point of the shape.
Vec3d emission_normal(const LightShape& shape, const Vec3d& p);

/// Whether a light that emits inwards hides its point `on_light` from x: that lies on the far side of a
/// closed wall, or out through the side of a tube. For queries that do not meet the light's own surface.
bool behind_own_wall(const LightShape& shape, const Vec3d& on_light, const Vec3d& x);

struct PointEmitter {
  Vec3f position;
  Rgb intensity;  ///< W sr⁻¹
};

/// Falls off from full inside cos_inner to nothing outside cos_outer (pbrt-v3 §12.3.1).
struct SpotEmitter {
  Vec3f position, axis;  ///< axis unit
  Rgb intensity;         ///< W sr⁻¹ on the axis
  float cos_inner = 1, cos_outer = 0;
};

struct DistantEmitter {
  Vec3f towards_light;  ///< unit
  Rgb irradiance;       ///< W m⁻² on a surface that faces it
};

using DeltaEmitter = std::variant<PointEmitter, SpotEmitter, DistantEmitter>;

/// What arrives at x from a light without extent.
struct DeltaLight {
  Vec3f wi;        ///< unit, towards the light
  Rgb irradiance;  ///< on a surface that faces it, if nothing hides it
  /// The shadow segment ends here; for a distant light beyond everything.
  Vec3f end;
};

/// `reach`: a length that leads from x out of the scene.
DeltaLight delta_light_at(const DeltaEmitter& emitter, const Vec3f& x, float reach);

}  // namespace penumbra

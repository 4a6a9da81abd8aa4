#pragma once
// The shaft: everything between a point x and a flat light. One walk through the hierarchy finds what can
// hide any of the light from x; it then serves every line and every shadow segment from x to that light.
#include <array>
#include <memory>

#include "worker/geometry/geometry.h"

namespace penumbra {

/// A flat light as a shaft wants it: a convex polygon that emits to the side from which its corners go round
/// counterclockwise. Made once per light.
struct LightPolygon {
  /// Of a quad: o, o+u, o+u+v, o+v. `light` and `light_primitives` as in LineQuery.
  static LightPolygon quad(const Vec3f& o, const Vec3f& u, const Vec3f& v, PrimitiveId light,
                           uint32_t light_primitives);
  static LightPolygon triangle(const Vec3f& p0, const Vec3f& p1, const Vec3f& p2, PrimitiveId light,
                               uint32_t light_primitives);

  std::array<Vec3d, 4> corners;  ///< a triangle repeats its last one
  Vec3d normal;                  ///< unit, emission side; not finite for a light without area
  double normal_scale = 0;       ///< 1 / (sum of its components' absolute values)
  double largest = 0;            ///< of all coordinates' absolute values
  PrimitiveId light;
  uint32_t light_primitives = 0;

 private:
  static LightPolygon of(const std::array<Vec3d, 4>& corners, PrimitiveId light, uint32_t light_primitives);
};

struct ShaftQuery {
  Vec3f x;  ///< as in LineQuery
  const LightPolygon* light = nullptr;
  Vec3f horizon{0, 0, 0};  ///< unit normal: all chords and points asked for lie on its side of x; 0: anywhere
};

/// What a shaft holds.
enum class ShaftContent {
  kClear,   ///< nothing: all of the light is visible
  kHidden,  ///< one triangle hides all of the light
  kFew,     ///< some triangles that may hide a part of it: they are listed
  kMany,    ///< more than a list is worth, or x too close to the light's plane to tell: ask for each line
};

/// The last shaft that a thread entered; Geometry fills it. Keeps its memory from one shaft to the next.
class Shaft {
 public:
  Shaft();
  Shaft(Shaft&&) noexcept;
  Shaft& operator=(Shaft&&) noexcept;
  ~Shaft();

  ShaftContent content() const { return content_; }
  /// Triangles that the list holds; 0 unless kFew.
  size_t listed() const;
  /// Of the list, in the world: i < listed().
  std::array<Vec3f, 3> triangle(size_t i) const;

  struct Parts;

 private:
  friend class Geometry;
  ShaftContent content_ = ShaftContent::kMany;
  std::unique_ptr<Parts> parts_;
};

}  // namespace penumbra

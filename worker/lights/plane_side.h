#pragma once
#include <cmath>

#include "scenes/math.h"

namespace penumbra {

/// A flat light's plane and where x is.
struct PlaneSide {
  Vec3d normal{0, 0, 0};  ///< unit, along u × v; 0 for parallel edges
  double twice_area = 0;  ///< |u × v|
  double distance = 0;    ///< of x in front; 0 behind, and where rounding leaves the side undecided
};

/// Of the plane of edges u and v; `offset` is x − (a point of the plane).
///
/// The determinant offset · (u × v) has six products of three factors. With exact offset and edges
/// (differences of floats) its rounding error is below 5ε of the sum of their magnitudes, ε = 2⁻⁵³: one for
/// the inner product, one for the difference, one for the outer product, two for the sum (Higham 2002, §3.1).
/// Below that the sign means nothing, and a point in the light's plane sees nothing of the light.
inline PlaneSide side_of_plane(const Vec3d& offset, const Vec3d& u, const Vec3d& v) {
  const double a = u.y * v.z, b = u.z * v.y, c = u.z * v.x, d = u.x * v.z, e = u.x * v.y, f = u.y * v.x;
  const Vec3d n(a - b, c - d, e - f);
  const double length = n.length();
  if (!(length > 0)) return {};
  const double magnitude = std::abs(offset.x) * (std::abs(a) + std::abs(b)) +
                           std::abs(offset.y) * (std::abs(c) + std::abs(d)) +
                           std::abs(offset.z) * (std::abs(e) + std::abs(f));
  const double determinant = offset.dot(n);
  return {n / length, length, determinant > 5 * 0x1p-53 * magnitude ? determinant / length : 0};
}

}  // namespace penumbra

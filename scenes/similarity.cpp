#include "scenes/similarity.h"

#include <cmath>
#include <limits>

namespace penumbra {

/// Lengths of the transformed unit axes; equal to rounding for a similarity. The bound is that of float
/// input: a similarity written with seven digits is one.
bool is_similarity(const Matrix& m, double& scale) {
  const Vec3d x(m[0][0], m[0][1], m[0][2]), y(m[1][0], m[1][1], m[1][2]), z(m[2][0], m[2][1], m[2][2]);
  scale = x.length();
  const double slack = 16 * std::numeric_limits<float>::epsilon() * scale;
  return std::abs(y.length() - scale) <= slack && std::abs(z.length() - scale) <= slack &&
         std::abs(x.dot(y)) <= slack * scale && std::abs(x.dot(z)) <= slack * scale &&
         std::abs(y.dot(z)) <= slack * scale;
}

}  // namespace penumbra

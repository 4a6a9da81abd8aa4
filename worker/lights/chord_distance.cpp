#include "worker/lights/chord_distance.h"

#include <cmath>
#include <limits>

namespace penumbra {

ChordDistance::ChordDistance(const Vec3d& a, const Vec3d& along) : length_(along.length()) {
  if (!(length_ > 0)) {
    d_ = a.length();
    return;
  }
  d_ = a.cross(along).length() / length_;
  foot_ = -a.dot(along) / (length_ * length_);
}

double ChordDistance::at(double s) const {
  return std::hypot(d_, length_ * (s - foot_));
}

/// √(r² − d²) / L, the difference as a product: where the distance hardly changes along the chord, r and d
/// agree in most digits, and r − d is exact.
double ChordDistance::half_width(double r) const {
  if (!(r > d_)) return 0;
  if (!(length_ > 0)) return std::numeric_limits<double>::infinity();
  return std::sqrt((r - d_) * (r + d_)) / length_;
}

}  // namespace penumbra

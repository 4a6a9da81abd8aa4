#pragma once
// The pixel filter, importance-sampled: a camera sample belongs to one pixel only, pixels share none.
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/description.h"

namespace penumbra {

/// Offset from the pixel's centre (pixels) and the sample's weight: the sign of the filter times
/// ∫|f| / ∫f, so that a constant image stays itself.
struct FilterSample {
  Vec2d offset;
  double weight = 1;
};

/// A separable filter f(x) g(y) over its radius.
class Filter {
 public:
  /// pbrt's box, triangle, gaussian, mitchell (v3 and v4 parameters and defaults). Others: gaussian, with
  /// a warning. InvalidArgument for a radius that is not positive and finite.
  static absl::StatusOr<Filter> build(const SceneDescription& description, std::vector<std::string>& warnings);

  /// The pixel's centre, always.
  static Filter centre();

  FilterSample sample(const Vec2d& u) const;
  /// Along one axis, 0 or 1: the offset at u, whose weight multiplies `weight`; and the u of an offset.
  double sample_along(int axis, double u, double& weight) const { return axes_[axis].sample(u, weight); }
  double place_of(int axis, double offset) const { return axes_[axis].place_of(offset); }
  Vec2d radius() const { return {axes_[0].radius, axes_[1].radius}; }

 private:
  /// |f| as a piecewise linear function between equally spaced knots, with its running integral.
  struct Axis {
    double radius = 0.5;
    std::vector<double> values;   ///< f at the knots; empty: box
    std::vector<double> sums;     ///< ∫|f| up to a knot
    double sign_ratio = 1;        ///< ∫|f| / ∫f
    double sample(double u, double& weight) const;
    /// The inverse of sample().
    double place_of(double offset) const;
  };
  template <class F>
  static Axis tabulate(double radius, F f);

  Axis axes_[2];
};

}  // namespace penumbra

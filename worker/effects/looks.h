#pragma once
// Where to look at what is seen along a line, when it is known what that is from where to where.
#include <vector>

#include "worker/geometry/geometry.h"

namespace penumbra {

/// A point of [0,1] to be looked at, and its weight.
struct Look {
  double at = 0, weight = 1;
};

/// `seen`: ascending intervals that cover [0,1]; u in [0,1). Weights sum to 1, and for a uniform u the
/// weighted sum of any function over the looks is its mean over [0,1], whatever the intervals are.
void looks_along(const std::vector<SeenInterval>& seen, double u, std::vector<Look>& out);

}  // namespace penumbra

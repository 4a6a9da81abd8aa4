#include "film/moments.h"

#include "proto/status.h"

namespace penumbra {

void Moments::add(double group_mean, double group_weight) {
  PENUMBRA_CHECK(group_weight > 0);
  merge({1, group_weight, group_mean, 0});
}

double Moments::variance_of_mean() const {
  if (groups < 2) return 0;
  return m2 / (static_cast<double>(groups - 1) * weight);
}

}  // namespace penumbra

#include "film/moments.h"

#include "proto/status.h"

namespace penumbra {

void Moments::add(double group_mean, double group_weight) {
  PENUMBRA_CHECK(group_weight > 0);
  merge({1, group_weight, group_mean, 0});
}

void Moments::merge(const Moments& other) {
  if (other.groups == 0) return;
  if (groups == 0) {  // exactly the other, with no rounding
    *this = other;
    return;
  }
  const double total = weight + other.weight;
  const double distance = other.mean - mean;
  const double share = other.weight / total;
  mean += distance * share;
  m2 += other.m2 + distance * distance * weight * share;
  weight = total;
  groups += other.groups;
}

double Moments::variance_of_mean() const {
  if (groups < 2) return 0;
  return m2 / (static_cast<double>(groups - 1) * weight);
}

}  // namespace penumbra

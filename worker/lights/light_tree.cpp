#include "worker/lights/light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "proto/status.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kBuckets = 12;

double surface_area(const LightBounds& b) {
  const Vec3d d = b.hi - b.lo;
  return 2 * (d.x * d.y + d.y * d.z + d.z * d.x);
}

/// Solid angle into which the cone of normals emits, weighted by the cosine beyond the normals (Conty & Kulla
/// 2018, §4.2): 2π(1 − cos θo) + π/2 (2 θw sin θo − cos(θo − 2 θw) − 2 θo sin θo + cos θo), θw = min(θo + θe,
/// π).
double emission_measure(const LightBounds& b) {
  const double cos_o = std::min(b.normals.cos_spread, 1.0), o = std::acos(cos_o), sin_o = std::sin(o);
  const double w = std::min(o + std::acos(b.cos_emission), kPi);
  return 2 * kPi * (1 - cos_o) + kPi / 2 * (2 * w * sin_o - std::cos(o - 2 * w) - 2 * o * sin_o + cos_o);
}

/// Cost of a set of lights as a child (the surface area orientation heuristic, §4.2). Where all boxes are
/// points or segments the area says nothing: the squared diagonal stands beside it.
double cost(const LightBounds& b) {
  return b.power * emission_measure(b) * (surface_area(b) + (b.hi - b.lo).length2());
}

double centre(const LightBounds& b, int axis) {
  return 0.5 * (b.lo[axis] + b.hi[axis]);
}

struct Bucket {
  LightBounds bounds;
  size_t count = 0;
  void add(const LightBounds& b) { bounds = count++ == 0 ? b : join(bounds, b); }
  void add(const Bucket& b) {
    if (b.count == 0) return;
    bounds = count == 0 ? b.bounds : join(bounds, b.bounds);
    count += b.count;
  }
};

struct Split {
  int axis = -1;
  double at = 0;  ///< centres below go left
  double cost = std::numeric_limits<double>::infinity();
};

/// The best of the splits between buckets along one axis.
Split best_split(std::span<const LightBounds> lights, std::span<const uint32_t> order, int axis, double lo,
                 double hi, double longest) {
  std::array<Bucket, kBuckets> buckets;
  const double step = (hi - lo) / kBuckets;
  for (const uint32_t l : order) {
    const int b = std::clamp(int((centre(lights[l], axis) - lo) / step), 0, kBuckets - 1);
    buckets[size_t(b)].add(lights[l]);
  }
  std::array<double, kBuckets> above{};
  Bucket sum;
  for (size_t b = kBuckets - 1; b > 0; --b) {
    sum.add(buckets[b]);
    above[b] = sum.count > 0 ? cost(sum.bounds) : std::numeric_limits<double>::infinity();
  }
  Split best;
  sum = {};
  for (size_t b = 1; b < kBuckets; ++b) {
    sum.add(buckets[b - 1]);
    if (sum.count == 0 || sum.count == order.size()) continue;
    // Thin boxes make poor estimates: an axis is charged for being shorter than the longest (§4.2).
    const double c = longest / (hi - lo) * (cost(sum.bounds) + above[b]);
    if (c < best.cost) best = {axis, lo + step * double(b), c};
  }
  return best;
}

/// How many of the lights go to the first child; `order` is rearranged.
size_t partition(std::span<const LightBounds> lights, std::span<uint32_t> order) {
  Vec3d lo(std::numeric_limits<double>::infinity()), hi = -lo;
  for (const uint32_t l : order)
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], centre(lights[l], a));
      hi[a] = std::max(hi[a], centre(lights[l], a));
    }
  const Vec3d extent = hi - lo;
  const double longest = std::max({extent.x, extent.y, extent.z});
  Split best;
  for (int a = 0; a < 3; ++a) {
    if (!(extent[a] > 0)) continue;
    const Split s = best_split(lights, order, a, lo[a], hi[a], longest);
    if (s.cost < best.cost) best = s;
  }
  if (best.axis >= 0) {
    const auto middle = std::partition(order.begin(), order.end(),
                                       [&](uint32_t l) { return centre(lights[l], best.axis) < best.at; });
    const size_t first = size_t(middle - order.begin());
    if (first > 0 && first < order.size()) return first;
  }
  return order.size() / 2;  // all in one place, or parted by rounding alone
}

}  // namespace

LightTree::LightTree(std::span<const LightBounds> lights) : leaves_(lights.size()) {
  if (lights.empty()) return;
  PENUMBRA_CHECK(lights.size() < kNoNode / 2);
  nodes_.reserve(2 * lights.size() - 1);
  std::vector<uint32_t> order(lights.size());
  std::iota(order.begin(), order.end(), 0u);
  build(lights, order, kNoNode);
}

uint32_t LightTree::build(std::span<const LightBounds> lights, std::span<uint32_t> order, uint32_t parent) {
  const uint32_t index = uint32_t(nodes_.size());
  nodes_.emplace_back();
  nodes_[index].parent = parent;
  if (order.size() == 1) {
    nodes_[index].light = order[0];
    nodes_[index].bounds = lights[order[0]];
    leaves_[order[0]] = index;
    return index;
  }
  const size_t first = partition(lights, order);
  build(lights, order.first(first), index);
  const uint32_t second = build(lights, order.subspan(first), index);
  nodes_[index].second = second;
  nodes_[index].bounds = join(nodes_[index + 1].bounds, nodes_[second].bounds);
  return index;
}

double LightTree::importance(const Receiver& receiver) const {
  return nodes_.empty() ? 0 : penumbra::importance(nodes_[0].bounds, receiver);
}

double LightTree::share_of_first(uint32_t node, const Receiver& receiver) const {
  const double a = penumbra::importance(nodes_[node + 1].bounds, receiver);
  const double b = penumbra::importance(nodes_[nodes_[node].second].bounds, receiver);
  return a + b > 0 ? a / (a + b) : -1;
}

DrawnLight LightTree::draw(const Receiver& receiver, double u) const {
  if (nodes_.empty() || !(importance(receiver) > 0)) return {};
  uint32_t node = 0;
  double probability = 1;
  while (nodes_[node].second != kNoNode) {
    const double share = share_of_first(node, receiver);
    if (share < 0) return {};
    const bool first = u < share;
    // What is left of u is uniform again; the quotient may round up to 1.
    u = std::min(first ? u / share : (u - share) / (1 - share), 1 - 0x1p-53);
    probability *= first ? share : 1 - share;
    node = first ? node + 1 : nodes_[node].second;
  }
  return {nodes_[node].light, probability};
}

double LightTree::probability(const Receiver& receiver, size_t light) const {
  if (!(importance(receiver) > 0)) return 0;
  double probability = 1;
  for (uint32_t node = leaves_[light]; nodes_[node].parent != kNoNode; node = nodes_[node].parent) {
    const uint32_t parent = nodes_[node].parent;
    const double share = share_of_first(parent, receiver);
    if (share < 0) return 0;
    probability *= node == parent + 1 ? share : 1 - share;
  }
  return probability;
}

}  // namespace penumbra

#include "worker/geometry/shaft.h"

#include <algorithm>

#include "proto/status.h"
#include "worker/geometry/line_fan.h"
#include "worker/geometry/shaft_list.h"

namespace penumbra {
namespace {

/// Does what hid the light from the last x hide it from this one as well?
bool hidden_as_before(const LineBvh& bvh, const Excluded& excluded, const Shaft::Parts& shaft) {
  if (shaft.cover_bvh != bvh.id) return false;
  const PairBlock& block = bvh.world.blocks[shaft.cover_block];
  if (excluded.holds(block.id[shaft.cover_which][shaft.cover_lane])) return false;
  return shaft.planes.covered_by(block.triangle(shaft.cover_lane, shaft.cover_which).data());
}

}  // namespace

Shaft::Shaft() : parts_(std::make_unique<Parts>()) {}
Shaft::Shaft(Shaft&&) noexcept = default;
Shaft& Shaft::operator=(Shaft&&) noexcept = default;
Shaft::~Shaft() = default;

size_t Shaft::listed() const {
  return content_ == ShaftContent::kFew ? static_cast<size_t>(parts_->list.size()) : 0;
}

std::array<Vec3f, 3> Shaft::triangle(size_t i) const {
  PENUMBRA_CHECK(i < listed());
  return parts_->list.triangle(static_cast<int>(i));
}

void ShaftList::add(const PairBlock& block, int lane, bool first, bool second) {
  PENUMBRA_CHECK(triangles_ + first + second <= kMost);
  PairBlock& to = blocks_[lanes_ / kWidth];
  const int at = lanes_ % kWidth;
  to.copy(at, block, lane);
  if (first != second) to.keep_one(at, second ? 1 : 0);
  for (int which = 0; which < first + second; ++which)
    places_[triangles_++] = {static_cast<uint8_t>(lanes_), static_cast<uint8_t>(which)};
  ++lanes_;
}

void ShaftList::finish() {
  for (int first = 0; first < lanes_; first += kWidth)
    blocks_[first / kWidth].finish(std::min(lanes_ - first, kWidth));
}

ShaftContent enter_shaft(const LineBvh& bvh, LinePath path, const ShaftQuery& query, Shaft::Parts& shaft,
                         QueryCounters& counters) {
  shaft.list.clear();
  if (bvh.world.nodes.empty() || path == LinePath::kScalar) return ShaftContent::kMany;
  set_up(shaft.planes, query, bvh.world.reach(Vec3d(query.x)));
  if (!shaft.planes.usable) return ShaftContent::kMany;
  LineQuery light;
  light.light = query.light->light;
  light.light_primitives = query.light->light_primitives;
  const Excluded excluded = excluded_in(bvh, light, kNone);
  if (hidden_as_before(bvh, excluded, shaft)) return ShaftContent::kHidden;
  shaft.cover_bvh = 0;  // a neighbour of a point that sees some of the light mostly sees some, too
  return path == LinePath::kAvx512 ? walk_shaft_avx512(bvh, excluded, shaft, counters)
                                   : walk_shaft_avx2(bvh, excluded, shaft, counters);
}

void visible_in_list(const LineBvh& bvh, LinePath path, const ShaftList& list,
                     std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                     QueryCounters& counters) {
  out.resize(queries.size());
  counters.line_queries += queries.size();
  if (path == LinePath::kAvx512) return visible_in_list_avx512(bvh, list, queries, out, counters);
  visible_in_list_avx2(bvh, list, queries, out, counters);
}

}  // namespace penumbra

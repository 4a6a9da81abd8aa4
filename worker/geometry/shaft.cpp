#include "worker/geometry/shaft.h"

#include "proto/status.h"
#include "worker/geometry/line_fan.h"
#include "worker/geometry/shaft_list.h"

namespace penumbra {
namespace {

/// Does what hid the light from the last x hide it from this one as well?
bool hidden_as_before(const LineBvh& bvh, const Excluded& excluded, const Shaft::Parts& shaft) {
  if (shaft.cover_bvh != bvh.id) return false;
  const TriangleBlock& block = bvh.world.blocks[shaft.cover_block];
  if (excluded.holds(block.id[shaft.cover_lane])) return false;
  Vec3f p[3];
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 3; ++k) p[c][k] = block.p[c][k][shaft.cover_lane];
  return shaft.planes.covered_by(p);
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
  const TriangleBlock& block = parts_->list.blocks()[i / kWidth];
  std::array<Vec3f, 3> corners;
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 3; ++k) corners[size_t(c)][k] = block.p[c][k][i % kWidth];
  return corners;
}

void ShaftList::finish() {
  if (count_ % kWidth == 0) return;
  TriangleBlock& last = blocks_[count_ / kWidth];
  for (int lane = count_ % kWidth; lane < kWidth; ++lane) {
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) last.p[c][k][lane] = 0;
    last.id[lane] = kNone;
  }
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

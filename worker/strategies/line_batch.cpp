#include "worker/strategies/line_batch.h"

namespace penumbra {

void LineBatch::clear() {
  count_ = 0;
  above_.clear();
  below_.clear();
  intervals_.clear();
}

size_t LineBatch::add(const LightLine& line, const ShadingPoint& point, const AreaEmitter* emitter) {
  const size_t handle = count_++;
  if (lines_.size() < count_) lines_.resize(count_);
  lines_[handle] = {line};
  if (!(line.scale > 0)) return handle;
  const Vec3d x(point.above), normal(point.normal);
  add_part(above_, handle, clip_to_horizon(line, x, normal), point, point.above, emitter);
  if (point.transmits)
    add_part(below_, handle, clip_to_horizon(line, x, -normal), point, point.below, emitter);
  return handle;
}

void LineBatch::add_part(Side& side, size_t line, const Interval& range, const ShadingPoint& point,
                         const Vec3f& x, const AreaEmitter* emitter) {
  if (!(range.lo < range.hi)) return;
  const LightLine& l = lines_[line].line;
  const Vec3d ab = l.b - l.a;
  LineQuery query;
  query.x = x;
  query.a = Vec3f(l.a + ab * double(range.lo));
  query.b = Vec3f(l.a + ab * double(range.hi));
  if (emitter != nullptr) {
    query.light = {emitter->instance, emitter->mesh, emitter->first_primitive};
    query.light_primitives = emitter->primitives;
    query.plane = {l.n, emitter->rounding};
  }
  query.time = point.time;
  side.queries.push_back(query);
  side.parts.push_back({line, range});
}

void LineBatch::trace(const Geometry& geometry, const Shaft* shaft, QueryCounters& counters) {
  if (shaft != nullptr)
    geometry.visible(*shaft, above_.queries, above_.visible, counters);
  else
    geometry.visible(above_.queries, above_.visible, counters);
  if (!below_.queries.empty()) geometry.visible(below_.queries, below_.visible, counters);
  size_t next_above = 0, next_below = 0;
  for (size_t line = 0; line < count_; ++line) {
    lines_[line].first = intervals_.size();
    gather(line, above_, next_above);
    gather(line, below_, next_below);
    lines_[line].last = intervals_.size();
    std::sort(intervals_.begin() + std::ptrdiff_t(lines_[line].first), intervals_.end(),
              [](const Interval& a, const Interval& b) { return a.lo < b.lo; });
    for (size_t i = lines_[line].first; i < lines_[line].last; ++i)
      lines_[line].measure += relative_measure(lines_[line].line, intervals_[i].lo, intervals_[i].hi);
  }
}

void LineBatch::gather(size_t line, const Side& side, size_t& next) {
  for (; next < side.parts.size() && side.parts[next].line == line; ++next) {
    const Interval& range = side.parts[next].range;
    const float length = range.hi - range.lo;
    for (const Interval& v : side.visible[next]) {
      // v = 1 must give back range.hi to the bit: the part's end is the chord's or the horizon's.
      const float lo = range.lo + length * v.lo, hi = v.hi == 1 ? range.hi : range.lo + length * v.hi;
      if (lo < hi) intervals_.push_back({lo, hi});
    }
  }
}

std::span<const Interval> LineBatch::visible(size_t handle) const {
  const Line& l = lines_[handle];
  return {intervals_.data() + l.first, l.last - l.first};
}

bool LineBatch::sees(size_t handle, double s) const {
  for (const Interval& i : visible(handle))
    if (s >= i.lo && s <= i.hi) return true;
  return false;
}

}  // namespace penumbra

#include "worker/effects/transient.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace penumbra {

TimeBins::TimeBins(const Transient& transient)
    : transient_(transient), values_(size_t(transient.bins), Vec3d(0)), holds_(size_t(transient.bins)) {}

void TimeBins::stand_at(double length, const Rgb& throughput) {
  length_ = length;
  throughput_ = Vec3d(throughput) * weight_;
}

int TimeBins::bin_of(double length) const {
  if (!(length >= transient_.t0)) return -1;
  if (!(length < transient_.t1)) return transient_.bins;
  int bin = int((length - transient_.t0) / (transient_.t1 - transient_.t0) * transient_.bins);
  bin = std::min(bin, transient_.bins - 1);
  // The quotient's rounding may be off by one: the edges themselves decide, here as for lines.
  while (length < transient_.edge(bin)) --bin;
  while (length >= transient_.edge(bin + 1)) ++bin;
  return bin;
}

void TimeBins::add(double distance, const Rgb& light) {
  const int bin = bin_of(length_ + distance);
  if (bin >= 0 && bin < transient_.bins) add_to(bin, light);
}

void TimeBins::add_to(int bin, const Rgb& light) {
  if (light == Rgb(0)) return;
  if (!holds_[size_t(bin)]) {
    holds_[size_t(bin)] = true;
    touched_.push_back(bin);
  }
  values_[size_t(bin)] += throughput_ * Vec3d(light);
}

void TimeBins::cut(const LightLine& line, const Vec3d& x, std::span<const Interval> visible,
                   std::vector<LinePart>& out) const {
  out.clear();
  const ChordDistance chord((line.corner - x) + line.from, line.along);
  for (const Interval& part : visible) {
    const double lo = part.lo, hi = part.hi, foot = std::clamp(chord.foot(), lo, hi);
    cut_falling(chord, lo, foot, out);
    cut_growing(chord, foot, hi, out);
  }
  std::sort(out.begin(), out.end(), [](const LinePart& a, const LinePart& b) {
    return std::tie(a.bin, a.lo) < std::tie(b.bin, b.lo);
  });
  // Both sides of the foot may be of one bin: one part again, so that a stretch in one bin is what it was.
  size_t kept = 0;
  for (size_t i = 1; i < out.size(); ++i) {
    if (out[i].bin == out[kept].bin && out[i].lo == out[kept].hi)
      out[kept].hi = out[i].hi;
    else
      out[++kept] = out[i];
  }
  if (!out.empty()) out.resize(kept + 1);
}

/// Cuts are clamped to what is left, so that the parts of a stretch always make up all of it, however the
/// edges' places are rounded; a stretch whose ends lie in one bin is not cut at all.
void TimeBins::cut_falling(const ChordDistance& chord, double lo, double hi,
                           std::vector<LinePart>& out) const {
  if (!(lo < hi)) return;
  const int last = bin_of(length_ + chord.at(hi));
  for (int bin = bin_of(length_ + chord.at(lo)); bin > last; --bin) {
    const double end = std::clamp(chord.before(transient_.edge(bin) - length_), lo, hi);
    put(bin, lo, end, out);
    lo = end;
  }
  put(last, lo, hi, out);
}

void TimeBins::cut_growing(const ChordDistance& chord, double lo, double hi,
                           std::vector<LinePart>& out) const {
  if (!(lo < hi)) return;
  const int last = bin_of(length_ + chord.at(hi));
  for (int bin = bin_of(length_ + chord.at(lo)); bin < last; ++bin) {
    const double end = std::clamp(chord.after(transient_.edge(bin + 1) - length_), lo, hi);
    put(bin, lo, end, out);
    lo = end;
  }
  put(last, lo, hi, out);
}

void TimeBins::put(int bin, double lo, double hi, std::vector<LinePart>& out) const {
  if (lo < hi && bin >= 0 && bin < transient_.bins) out.push_back({bin, lo, hi});
}

}  // namespace penumbra

#include "worker/effects/looks.h"

#include <cmath>

namespace penumbra {
namespace {

/// A stretch of at least 1/kParts is looked at for sure, the shorter ones together by as many looks as their
/// sum holds such parts.
constexpr int kParts = 8;
/// A shorter gap in a stretch is the rounding of an edge that two triangles share.
constexpr double kGap = 0x1p-30;

/// A surface seen from lo to hi: of one mesh, for what its triangles share is worth one look.
struct Stretch {
  double lo, hi;
  uint32_t instance, mesh;
};

void merge(const std::vector<SeenInterval>& seen, std::vector<Stretch>& out) {
  out.clear();
  for (const SeenInterval& interval : seen) {
    const bool same =
        !out.empty() && out.back().instance == interval.id.instance && out.back().mesh == interval.id.mesh;
    if (same || (!out.empty() && interval.hi - interval.lo < kGap))
      out.back().hi = interval.hi;
    else
      out.push_back({interval.lo, interval.hi, interval.id.instance, interval.id.mesh});
  }
}

}  // namespace

/// Every stretch is a stratum: one uniform point in each, weighted by its length. Their number is bounded by
/// drawing the short ones: they are laid end to end, and cut into equal parts of which each has one point.
void looks_along(const std::vector<SeenInterval>& seen, double u, std::vector<Look>& out) {
  thread_local std::vector<Stretch> stretches;
  merge(seen, stretches);
  out.clear();
  double rest = 0;
  for (const Stretch& s : stretches) {
    const double length = s.hi - s.lo;
    if (length * kParts < 1)
      rest += length;
    else
      out.push_back({s.lo + u * length, length});
  }
  if (!(rest > 0)) return;
  const double parts = std::ceil(rest * kParts), step = rest / parts;
  double laid = 0, next = u * step;
  for (const Stretch& s : stretches) {
    const double length = s.hi - s.lo;
    if (length * kParts >= 1) continue;
    for (; next < laid + length; next += step) out.push_back({s.lo + (next - laid), step});
    laid += length;
  }
}

}  // namespace penumbra

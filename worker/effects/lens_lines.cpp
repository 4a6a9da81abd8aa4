// Depth of field by lines (Tzeng et al. 2012): a chord of the lens and the point in focus span a bow-tie;
// what is seen along it is known exactly, interval by interval, and each interval is looked at by a ray of
// its own.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/effects/lens.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

/// An interval of at least 1/kParts of the chord is looked at for sure, the shorter ones together by as many
/// rays as their sum holds such parts.
constexpr int kParts = 8;

/// The offset s in [-1,1] with distribution ∫ 2√(1−s²)/π = u. With s = −cos(θ/2) it is (θ − sin θ)/2π,
/// θ in [0,2π]: Kepler's equation of eccentricity 1.
double chord_offset(double u) {
  // By symmetry in the lower half, where θ − sin θ ~ θ³/6 gives a start below the root. The function is
  // convex up to π: the first of Newton's steps passes the root, the others fall to it; six reach double
  // precision.
  const bool upper = u > 0.5;
  const double target = 2 * kPi * (upper ? 1 - u : u);
  double theta = std::cbrt(6 * target);
  for (int i = 0; i < 6 && theta > 0; ++i) {
    const double slope = 2 * std::sin(theta / 2) * std::sin(theta / 2);  // 1 − cos θ
    if (!(slope > 0)) break;
    theta -= (theta - std::sin(theta) - target) / slope;
  }
  const double s = std::cos(theta / 2);
  return upper ? s : -s;
}

/// A surface seen along the chord from lo to hi: of one mesh, for what its triangles share is worth one look.
struct Stretch {
  double lo, hi;
  uint32_t instance, mesh;
};

void merge(const std::vector<SeenInterval>& seen, std::vector<Stretch>& out) {
  out.clear();
  for (const SeenInterval& interval : seen) {
    if (!out.empty() && out.back().instance == interval.id.instance && out.back().mesh == interval.id.mesh)
      out.back().hi = interval.hi;
    else
      out.push_back({interval.lo, interval.hi, interval.id.instance, interval.id.mesh});
  }
}

}  // namespace

DiskChord disk_chord(const Vec2d& u) {
  const double phi = kPi * u.x, s = chord_offset(u.y), half = std::sqrt(std::max(0.0, (1 - s) * (1 + s)));
  const Vec2d along(std::cos(phi), std::sin(phi)), across(-along.y, along.x);
  return {across * s - along * half, across * s + along * half};
}

/// Every stretch is a stratum: one uniform point in each, weighted by its length, estimates the mean over the
/// chord without bias whatever the stretches are. Their number is bounded by drawing the short ones: they are
/// laid end to end, and cut into equal parts of which each has one point.
void Lens::chord_rays(const CameraRay& pinhole, const CameraDraw& draw, std::vector<WeightedRay>& out) const {
  thread_local std::vector<SeenInterval> seen;
  thread_local std::vector<Stretch> stretches;
  const DiskChord chord = disk_chord(draw.sampler.lens(draw.i, draw.n));
  const Vec3d a = on_lens(chord.a), b = on_lens(chord.b);
  draw.geometry.nearest({a, b, centre_ + at_unit_depth(pinhole.direction) * focal_distance_}, seen,
                        draw.counters);
  merge(seen, stretches);

  const double u = draw.sampler.along_lens(draw.i, draw.n);
  const auto look = [&](double v, double weight) {
    out.push_back({ray(pinhole, a + (b - a) * v), float(weight)});
  };
  double rest = 0;
  for (const Stretch& s : stretches) {
    const double length = s.hi - s.lo;
    if (length * kParts < 1)
      rest += length;
    else
      look(s.lo + u * length, length);
  }
  if (!(rest > 0)) return;
  const double parts = std::ceil(rest * kParts), step = rest / parts;
  double laid = 0, next = u * step;
  for (const Stretch& s : stretches) {
    const double length = s.hi - s.lo;
    if (length * kParts >= 1) continue;
    for (; next < laid + length; next += step) look(s.lo + (next - laid), step);
    laid += length;
  }
}

}  // namespace penumbra

// Depth of field by lines (Tzeng et al. 2012): a chord of the lens and the point in focus span a bow-tie;
// what is seen along it is known exactly, interval by interval, and each interval is looked at by a ray of
// its own.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/effects/lens.h"
#include "worker/effects/looks.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

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

}  // namespace

DiskChord disk_chord(const Vec2d& u) {
  const double phi = kPi * u.x, s = chord_offset(u.y), half = std::sqrt(std::max(0.0, (1 - s) * (1 + s)));
  const Vec2d along(std::cos(phi), std::sin(phi)), across(-along.y, along.x);
  return {across * s - along * half, across * s + along * half};
}

void Lens::chord_rays(const CameraRay& pinhole, const CameraDraw& draw, std::vector<WeightedRay>& out) const {
  thread_local std::vector<SeenInterval> seen;
  thread_local std::vector<Look> looks;
  const DiskChord chord = disk_chord(draw.sampler.lens(draw.i, draw.n));
  const Vec3d a = on_lens(chord.a), b = on_lens(chord.b);
  FocusedChord query{a, b, centre_ + at_unit_depth(pinhole.direction) * focal_distance_, pinhole.time};
  if (draw.camera_moved != nullptr)
    for (Vec3d* p : {&query.a, &query.b, &query.focus}) draw.camera_moved->multVecMatrix(Vec3d(*p), *p);
  draw.geometry.nearest(query, seen, draw.counters);
  looks_along(seen, draw.sampler.along_lens(draw.i, draw.n), looks);
  for (const Look& look : looks) out.push_back({ray(pinhole, a + (b - a) * look.at), float(look.weight)});
}

}  // namespace penumbra

// Line strategies: chords and points on their visible part. The visible set is given: what is not hidden by a
// disk in the light's plane (chords with one gap, two ends or nothing) or by a strip.
#include <functional>
#include <numbers>

#include "tests/statistical/lights/cases.h"
#include "tests/statistical/lights/statistics.h"
#include "worker/lights/chords.h"
#include "worker/lights/line.h"

namespace penumbra::statistical {
namespace {

constexpr int kSamples = 40000;

/// One line strategy of one light seen from one x.
struct Strategy {
  std::string name;
  std::function<LightLine(double u)> choose;
  std::function<LightLine(const Vec3d& p)> through;
};

std::vector<Strategy> strategies(const Case& c, const SeenShape& seen) {
  std::vector<Strategy> all;
  for (const double degrees : {0.0, 30.0, 90.0, 137.0}) {
    const double radians = degrees * std::numbers::pi / 180;
    const ParallelChords chords(c.shape, radians);
    all.push_back({c.name + ", line-area@" + std::to_string(degrees),
                   [=](double u) { return chords.choose(u); },
                   [=](const Vec3d& p) { return chords.through(p); }});
    all.push_back({c.name + ", line-uniform@" + std::to_string(degrees),
                   [=](double u) { return chords.choose_uniform(u); },
                   [=](const Vec3d& p) { return chords.through_uniform(p); }});
  }
  if (has_line_solid_angle(c.shape))
    for (const bool along_u : {true, false})
      all.push_back(
          {c.name + (along_u ? ", line-sa@u" : ", line-sa@v"),
           [&seen, along_u](double u) { return choose_line_solid_angle(seen, along_u, u); },
           [&seen, along_u](const Vec3d& p) { return line_solid_angle_through(seen, along_u, p); }});
  return all;
}

std::vector<Case> line_cases() {
  std::vector<Case> all = concatenated({rectangle_cases(), parallelogram_cases(), triangle_cases()});
  return all;
}

/// What a disk on the light hides: centre in the light's plane, radius.
struct Blocker {
  Vec3d center;
  double radius;
};

Vec3d middle_of(const LightShape& shape) {
  if (const auto* q = std::get_if<QuadShape>(&shape)) return Vec3d(q->o) + 0.5 * (Vec3d(q->u) + Vec3d(q->v));
  const auto& t = std::get<TriangleShape>(shape);
  return (Vec3d(t.p0) + Vec3d(t.p1) + Vec3d(t.p2)) / 3.0;
}

/// The part of the line outside the disk.
std::vector<Interval> visible_part(const LightLine& line, const Blocker& blocker) {
  const Vec3d d = line.a - blocker.center;
  const double a = line.along.length2(), b = d.dot(line.along),
               c = d.length2() - blocker.radius * blocker.radius, discriminant = b * b - a * c;
  if (!(discriminant > 0)) return {{0, 1}};
  const double root = std::sqrt(discriminant);
  const auto lo = static_cast<float>((-b - root) / a), hi = static_cast<float>((-b + root) / a);
  std::vector<Interval> parts;
  if (hi <= 0 || lo >= 1) return {{0, 1}};
  if (lo > 0) parts.push_back({0, lo});
  if (hi < 1) parts.push_back({hi, 1});
  return parts;
}

bool inside(const std::vector<Interval>& parts, double s) {
  for (const Interval& part : parts)
    if (s >= part.lo && s <= part.hi) return true;
  return false;
}

/// Density at p: the chord through it, its visible part.
double density_at(const Strategy& strategy, const Vec3d& x, const Blocker& blocker, const Vec3d& p) {
  const LightLine line = strategy.through(p);
  const std::vector<Interval> visible = visible_part(line, blocker);
  const double s = parameter_of(line, p);
  return inside(visible, s) ? pdf_line(line, x, s, visible_measure(line, visible)) : 0;
}

TEST(LineStrategies, DensityThroughAPointIsThatOfTheSample) {
  for (const Case& c : line_cases()) {
    const SeenShape seen(c.shape, c.x);
    const Blocker blocker{middle_of(c.shape), 0.3};
    for (const Strategy& strategy : strategies(c, seen)) {
      for (int i = 0; i < 200; ++i) {
        const Vec2d u = random_square(10, i);
        const LightLine line = strategy.choose(u.x);
        const std::vector<Interval> visible = visible_part(line, blocker);
        const LightPoint point = sample_line(line, c.x, visible, u.y);
        if (visible.empty()) {
          EXPECT_EQ(point.pdf, 0);
          continue;
        }
        // The intervals are floats, and the chord through a point is off by the point's own rounding.
        const Vec3d nudged = strategy.through(point.p).a - line.a;
        EXPECT_LT(nudged.length(), 1e-9 * (1 + c.x.length())) << strategy.name;
        const double s = parameter_of(line, point.p);
        EXPECT_NEAR(pdf_line(line, c.x, s, visible_measure(line, visible)) / point.pdf, 1, 1e-6)
            << strategy.name;
        if (line.along.length() > 1e-3) {
          EXPECT_TRUE(inside(visible, s) || std::abs(s - visible[0].lo) < 1e-6 ||
                      std::abs(s - visible[0].hi) < 1e-6 || std::abs(s - visible.back().lo) < 1e-6)
              << strategy.name;
        }
      }
    }
  }
}

TEST(LineStrategies, DensityIntegratesToOneOverTheVisibleSet) {
  // ∫ pdf dω over the light is 1 as long as every chord has a visible part; by points half uniform in area,
  // half in solid angle, so that the ratio is bounded wherever the strategy puts its density.
  for (const Case& c : line_cases()) {
    const SeenShape seen(c.shape, c.x);
    const double size = std::sqrt(area(c.shape));
    for (const double radius : {0.0, 0.2}) {
      const Blocker blocker{middle_of(c.shape), radius * size};
      for (const Strategy& strategy : strategies(c, seen)) {
        bool every_chord_visible = true;
        for (int i = 0; i < 500; ++i)
          every_chord_visible &= !visible_part(strategy.choose((i + 0.5) / 500), blocker).empty();
        if (!every_chord_visible) continue;
        MeanTest mean;
        for (int i = 0; i < kSamples / 4; ++i) {
          const Vec2d u = random_square(11, i);
          const LightPoint p = i % 2 == 0 ? sample_area(c.shape, c.x, u) : seen.sample(u);
          const double mixture = 0.5 * (pdf_area(c.shape, c.x, p.p, p.n) + seen.pdf(p.p, p.n));
          mean.add(density_at(strategy, c.x, blocker, p.p) / mixture);
        }
        EXPECT_LT(std::abs(mean.mean() - 1), 5 * mean.error() + 1e-6)
            << strategy.name << " behind " << radius;
      }
    }
  }
}

TEST(LineStrategies, DensityTimesJacobianIsOne) {
  constexpr int kTries = 200;
  for (const Case& c : line_cases()) {
    const SeenShape seen(c.shape, c.x);
    const Blocker blocker{middle_of(c.shape) + Vec3d(0.4, 0, 0), 0.3};
    for (const Strategy& strategy : strategies(c, seen)) {
      for (const bool hidden : {false, true}) {
        const auto sample = [&](const Vec2d& u) {
          const LightLine line = strategy.choose(u.x);
          const std::vector<Interval> visible =
              hidden ? visible_part(line, blocker) : std::vector<Interval>{{0, 1}};
          return sample_line(line, c.x, visible, u.y);
        };
        int off = 0, judged = 0;
        for (int i = 0; i < kTries; ++i) {
          const Vec2d u = random_square(12, i) * 0.96 + Vec2d(0.02);
          const LightPoint point = sample(u);
          if (point.pdf == 0) continue;
          ++judged;
          const auto from_x = [&](const Vec2d& w) { return sample(w).p - c.x; };
          // Visible ends are floats: with a step of 1e-3 their rounding is 1e-4 of the difference.
          const double jacobian = direction_jacobian(from_x, u, hidden ? 2e-3 : 2e-4);
          if (!(std::abs(point.pdf * jacobian - 1) < (hidden ? 2e-2 : 1e-3))) ++off;
        }
        EXPECT_LE(off, (hidden ? 0.1 : 0.03) * judged) << strategy.name << (hidden ? ", partly hidden" : "");
      }
    }
  }
}

TEST(LineStrategies, UnhiddenLinesCoverTheLightAsThePointsDo) {
  // line-area: uniform in area, judged in the triangle's or the quad's own fractions; line-sa: 1/Ω.
  constexpr int kCells = 8;
  const std::vector<double> even(kCells * kCells, 1.0 / (kCells * kCells));
  for (const Case& c : concatenated({rectangle_cases(), parallelogram_cases()})) {
    const auto& quad = std::get<QuadShape>(c.shape);
    const Vec3d u(quad.u), v(quad.v), n = u.cross(v);
    const SeenShape seen(c.shape, c.x);
    for (const Strategy& strategy : strategies(c, seen)) {
      const bool angular = strategy.name.find("line-sa") != std::string::npos;
      // Offsets without regard to the chords' lengths crowd points on short chords: even on rectangles along their
      // edges only.
      if (strategy.name.find("line-uniform") != std::string::npos) continue;
      std::vector<int> hits(kCells * kCells);
      for (int i = 0; i < kSamples; ++i) {
        const Vec2d r = random_square(13, i);
        const std::vector<Interval> whole = {{0, 1}};
        const LightPoint p = sample_line(strategy.choose(r.x), c.x, whole, r.y);
        const Vec3d d = p.p - Vec3d(quad.o);
        Vec2d f(d.cross(v).dot(n) / n.length2(), u.cross(d).dot(n) / n.length2());
        if (angular) {
          EXPECT_DOUBLE_EQ(p.pdf, 1 / seen.solid_angle());
          f = seen.rectangle()->invert(
              {std::min(std::max(f.x, 0.0), 1.0), std::min(std::max(f.y, 0.0), 1.0)});
        }
        const auto cell = [](double t) {
          return std::min(std::max(static_cast<int>(t * kCells), 0), kCells - 1);
        };
        ++hits[cell(f.x) * kCells + cell(f.y)];
      }
      EXPECT_LT(chi_square_sigmas(hits, even), 4.5) << strategy.name;
    }
  }
}

}  // namespace
}  // namespace penumbra::statistical

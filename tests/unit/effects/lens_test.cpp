#include "worker/effects/lens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "proto/status.h"
#include "scenes/parser.h"
#include "tests/support/render.h"
#include "worker/render/scene.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

SceneDescription described(double radius, double focus, const Matrix& to_camera = Matrix()) {
  SceneDescription d;
  d.files = {"lens.pbrt"};
  d.camera.type = "perspective";
  for (const auto& [name, value] :
       {std::pair("fov", 60.), {"lensradius", radius}, {"focaldistance", focus}}) {
    Param p;
    p.type = "float";
    p.name = name;
    p.loc = {0, 3, 7};
    p.numbers = {value};
    d.camera.params.all.push_back(p);
  }
  d.camera_placement.start = d.camera_placement.end = to_camera;
  return d;
}

std::vector<WeightedRay> rays_of(const SceneDescription& d, const char* mix, const Geometry& geometry,
                                 int64_t pass) {
  const Lens lens = Lens::build(d).value();
  const Camera camera = Camera::build(d, 40, 30).value();
  const PassSampler sampler(SamplerKind::kIndependent, 5, 0, TaskKind::kRun, 17, pass, 1);
  QueryCounters counters;
  std::vector<WeightedRay> rays;
  lens.rays(camera.ray({31.3, 4.2}), {sampler, parse_mix(mix).value(), geometry, counters}, rays);
  return rays;
}

Geometry nothing() {
  return Geometry::build({}, {}, {}, 1).value();
}

TEST(Lens, EveryRayPassesThroughThePointInFocus) {
  Matrix to_camera;
  to_camera.setScale(Vec3d(-0.5, 0.5, 0.5));  // lengths of camera space are two of the world's
  to_camera = Matrix().setTranslation(Vec3d(-1, -2, 3)) * to_camera;
  for (const Matrix& m : {Matrix(), to_camera}) {
    const SceneDescription d = described(0.3, 4, m);
    const Vec3d centre = Vec3d(0) * m.inverse();
    const double scale = 1 / std::cbrt(std::abs(m.determinant()));
    const Camera camera = Camera::build(d, 40, 30).value();
    const Vec3d direction(camera.ray({31.3, 4.2}).direction);
    Vec3d axis;
    m.inverse().multDirMatrix(Vec3d(0, 0, 1), axis);
    axis.normalize();
    const Vec3d focus = centre + direction * (4 * scale / direction.dot(axis));
    double farthest = 0;
    for (const char* mix : {"sa", "sa/lens=line"})
      for (int64_t pass = 0; pass < 300; ++pass)
        for (const WeightedRay& seen : rays_of(d, mix, nothing(), pass)) {
          const Vec3d from = Vec3d(seen.ray.origin) - centre;
          EXPECT_NEAR(from.dot(axis), 0, 1e-6);
          EXPECT_LE(from.length(), 0.3 * scale * (1 + 1e-6));
          farthest = std::max(farthest, from.length());
          const Vec3d to_focus = focus - Vec3d(seen.ray.origin);
          EXPECT_LT(to_focus.cross(Vec3d(seen.ray.direction)).length(), 1e-6 * to_focus.length());
        }
    EXPECT_GT(farthest, 0.28 * scale);
  }
}

TEST(Lens, APointOfARandomChordIsUniformOnTheDisk) {
  // Chords of 64 × 64 strata, 16 random points of each: the share of points within radius r is r², and of
  // those in a sector its angle. A bin's standard deviation is at most 1 %.
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform;
  constexpr int kEdge = 64, kPoints = 16, kBins = 8;
  int rings[kBins] = {}, sectors[kBins] = {};
  for (int i = 0; i < kEdge; ++i)
    for (int j = 0; j < kEdge; ++j) {
      const DiskChord chord = disk_chord({(i + uniform(engine)) / kEdge, (j + uniform(engine)) / kEdge});
      EXPECT_NEAR(chord.a.length(), 1, 1e-12);
      EXPECT_NEAR(chord.b.length(), 1, 1e-12);
      for (int k = 0; k < kPoints; ++k) {
        const Vec2d p = chord.a + (chord.b - chord.a) * uniform(engine);
        ++rings[std::min(int(p.length2() * kBins), kBins - 1)];
        const double turn = (std::atan2(p.y, p.x) / std::numbers::pi + 1) / 2;
        ++sectors[std::min(int(turn * kBins), kBins - 1)];
      }
    }
  constexpr double kMean = double(kEdge) * kEdge * kPoints / kBins;
  for (int bin = 0; bin < kBins; ++bin) {
    EXPECT_NEAR(rings[bin], kMean, 0.05 * kMean) << bin;
    EXPECT_NEAR(sectors[bin], kMean, 0.05 * kMean) << bin;
  }
}

TEST(Lens, ChordsAreFiniteAtTheEndsOfTheirRange) {
  for (const double u : {0., 1e-300, 1e-20, 1e-9, 0.5, 1 - 0x1p-53})
    for (const double phi : {0., 0.25, 1 - 0x1p-53}) {
      const DiskChord chord = disk_chord({phi, u});
      for (const Vec2d& p : {chord.a, chord.b}) EXPECT_NEAR(p.length(), 1, 1e-12) << u;
    }
}

TEST(Lens, WeightsOfALineSumToOne) {
  for (int64_t pass = 0; pass < 50; ++pass) {
    double sum = 0;
    for (const WeightedRay& seen : rays_of(described(0.3, 4), "sa/lens=line", nothing(), pass))
      sum += seen.weight;
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

TEST(Lens, RefusesWhatIsNoFocalDistance) {
  for (const double focus : {0., -1., std::numeric_limits<double>::infinity()}) {
    const auto lens = Lens::build(described(0.1, focus));
    ASSERT_FALSE(lens.ok());
    EXPECT_THAT(message_of(lens.status()), HasSubstr("lens.pbrt:3:7: focaldistance"));
  }
  EXPECT_TRUE(Lens::build(described(0.1, 1e200)).ok());
}

TEST(Lens, EnormousFocalDistancesStayFinite) {
  for (const double focus : {1e-30, 1e200, 1e300})
    for (const char* mix : {"sa", "sa/lens=line"})
      for (const WeightedRay& seen : rays_of(described(0.1, focus), mix, nothing(), 3))
        EXPECT_NEAR(seen.ray.direction.length(), 1, 1e-5) << focus;
}

TEST(Lens, BothVersionsOfTheLanguageAskForIt) {
  const char* const kVersions[] = {
      "LookAt 0 0 -5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" [ 30 ] \"float lensradius\" [ 0.2 ] "
      "\"float focaldistance\" [ 5 ]\nWorldBegin\nShape \"sphere\"\nWorldEnd\n",
      "LookAt 0 0 -5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 30 \"float lensradius\" 0.2 "
      "\"float focaldistance\" 5\nWorldBegin\nShape \"sphere\"\n"};
  for (const char* text : kVersions) {
    const ScenePtr scene = test::load_text(text);
    ASSERT_TRUE(scene);
    ASSERT_TRUE(scene->effects.camera);
    EXPECT_NEAR(scene->effects.camera->blur(10), 0.02, 1e-15);
    EXPECT_NEAR(scene->effects.camera->blur(5), 0, 1e-15);
    EXPECT_NEAR(scene->effects.camera->blur(2.5), 0.04, 1e-15);
  }
}

}  // namespace
}  // namespace penumbra

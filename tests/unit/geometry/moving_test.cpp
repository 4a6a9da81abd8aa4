// A scene in motion at one time against the same scene standing where it is then: lines to the bit, rays to
// what Embree's single precision makes of a placement.
#include <gtest/gtest.h>

#include "scenes/transforms.h"
#include "tests/unit/geometry/hard_meshes.h"

namespace penumbra::testing {
namespace {

struct Mover {
  const TriangleMesh* mesh;
  Matrix start, end;
};

Matrix turned(double degrees, const Vec3d& axis) {
  return rotation(degrees, axis).value();
}

/// One object each; `time` none: in motion, else standing as they are then.
Geometry build(const TriangleMesh& world, const std::vector<Mover>& movers, std::optional<float> time) {
  std::vector<MeshInput> meshes{{&world, {}, true}};
  std::vector<ObjectInput> objects;
  std::vector<InstanceInput> instances;
  for (const Mover& mover : movers) {
    const auto motion = std::make_shared<const AnimatedTransform>(
        AnimatedTransform::between(mover.start, mover.end, {0, 1}).value());
    const auto object = static_cast<uint32_t>(objects.size());
    objects.push_back({object + 1, object + 2});
    meshes.push_back({mover.mesh, {}, true});
    if (time)
      instances.push_back({object, motion->at(double{*time}), nullptr});
    else
      instances.push_back({object, motion->at(0), motion});
  }
  return Geometry::build(meshes, objects, instances, 1).value();
}

class Moving : public ::testing::Test {
 protected:
  void expect_alike(const TriangleMesh& world, const std::vector<Mover>& movers, uint32_t seed) {
    const Geometry moving = build(world, movers, std::nullopt);
    Random random(seed);
    int hidden = 0, met = 0, apart = 0;
    for (int t = 0; t < 8; ++t) {
      const float time = t == 0 ? 0.f : t == 1 ? 1.f : random.uniform();
      const Geometry still = build(world, movers, time);
      for (int i = 0; i < 200; ++i) {
        lines_alike(moving, still, time, random, hidden);
        rays_alike(moving, still, time, random, met, apart);
      }
    }
    EXPECT_GT(hidden, 50);
    EXPECT_GT(met, 50);
    EXPECT_LE(apart, met / 50);  // grazing an edge
  }

 private:
  void lines_alike(const Geometry& moving, const Geometry& still, float time, Random& random, int& hidden) {
    LineQuery query;
    query.x = random.in_cube() * 2.f;
    query.a = random.in_cube() * 2.f;
    query.b = query.a + random.in_cube();
    query.time = time;
    moving.visible({&query, 1}, lines_, counters_);
    still.visible({&query, 1}, other_lines_, counters_);
    ASSERT_EQ(lines_[0].size(), other_lines_[0].size());
    for (size_t k = 0; k < lines_[0].size(); ++k) {
      ASSERT_EQ(lines_[0][k].lo, other_lines_[0][k].lo);
      ASSERT_EQ(lines_[0][k].hi, other_lines_[0][k].hi);
    }
    hidden += lines_[0].size() != 1 || lines_[0][0].lo > 0 || lines_[0][0].hi < 1;
  }

  void rays_alike(const Geometry& moving, const Geometry& still, float time, Random& random, int& met,
                  int& apart) {
    const Vec3f x = random.in_cube() * 2.f, y = random.in_cube() * 2.f;
    const Ray ray{x, (y - x).normalized(), 0, std::numeric_limits<float>::infinity(), time};
    const auto hit = moving.intersect(ray, counters_), other = still.intersect(ray, counters_);
    met += hit.has_value();
    if (hit.has_value() != other.has_value() || (hit && !(hit->id == other->id))) {
      ++apart;
    } else if (hit) {
      EXPECT_EQ(hit->time, time);
      if (std::abs(hit->distance - other->distance) > 1e-4f * (1 + hit->distance)) ++apart;
    }
    apart += moving.occluded(x, y, counters_, time) != still.occluded(x, y, counters_);
  }

  std::vector<IntervalSet> lines_, other_lines_;
  QueryCounters counters_;
};

const Matrix kStill;

TEST_F(Moving, BallsThatFlyTurnAndGrow) {
  const TriangleMesh world = soup(40, 0.3f, 1), first = ball({0, 0, 0}, 0.6f, 8, 0.2f),
                     second = soup(60, 0.4f, 2);
  expect_alike(world,
               {{&first, translation({-1, 0, 0}), translation({1, 0.3, 0})},
                {&second, turned(10, {0, 1, 0}), scaling({0.5, 1, 1}) * turned(150, {0.2, 1, 0})}},
               3);
}

TEST_F(Moving, SliversThatTurn) {
  const TriangleMesh world = soup(10, 0.2f, 4), thin = needles(200, 5);
  expect_alike(world, {{&thin, kStill, turned(170, {1, 1, 0.1})}}, 6);
}

TEST_F(Moving, MoversThatTouch) {
  const TriangleMesh world = soup(10, 0.2f, 7), pile = plates(4, 0.1f);
  // The upper one rests on the lower one's last plate, and both go the same way.
  const Matrix up = translation({0, 0, 0.3});
  expect_alike(world, {{&pile, kStill, translation({0.5, 0, 0})}, {&pile, up, up * translation({0.5, 0, 0})}},
               8);
}

TEST_F(Moving, VeryFastOnes) {
  const TriangleMesh world = soup(60, 0.6f, 9), wide = ball({0, 0, 0}, 900, 8);
  expect_alike(world, {{&wide, translation({-3e4, 0, 0}), translation({3e4, 10, 0})}}, 10);
}

TEST_F(Moving, EverythingCollapsedIntoATinyMotion) {
  const TriangleMesh world = soup(10, 0.3f, 11), first = soup(60, 0.5f, 12);
  expect_alike(world, {{&first, kStill, translation({1e-12, 0, 0})}}, 13);
}

/// What a ray is said to meet over time against rays traced at many times. Returns the share of times at
/// which they disagree, of those at which something that moves is met or said to be.
double disagreement(const TriangleMesh& world, const std::vector<Mover>& movers,
                    const AnimatedTransform* camera, uint32_t seed) {
  const Geometry moving = build(world, movers, std::nullopt);
  Random random(seed);
  QueryCounters counters;
  std::vector<SeenInterval> seen;
  const Matrix to_camera = camera ? camera->at(0).inverse() : Matrix();
  int compared = 0, apart = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3f x = random.direction() * 2.5f, y = random.in_cube() * 0.8f;
    moving.nearest(RayInTime{Vec3d(x), Vec3d(y - x), camera, to_camera}, seen, counters);
    EXPECT_EQ(seen.front().lo, 0);
    EXPECT_EQ(seen.back().hi, 1);
    for (size_t k = 1; k < seen.size(); ++k) EXPECT_EQ(seen[k].lo, seen[k - 1].hi);
    size_t at = 0;
    for (int step = 0; step < 100; ++step) {
      const double time = (step + 0.5) / 100;
      while (seen[at].hi < time) ++at;
      Vec3d from(x), way(y - x);
      if (camera) {
        const Matrix m = to_camera * camera->at(time);
        m.multVecMatrix(Vec3d(from), from);
        m.multDirMatrix(Vec3d(way), way);
      }
      const auto hit = moving.intersect(
          {Vec3f(from), Vec3f(way), 0, std::numeric_limits<float>::infinity(), static_cast<float>(time)},
          counters);
      const PrimitiveId id = hit ? hit->id : PrimitiveId{};
      // Of a ray that meets nothing that moves nothing is said.
      if (!camera && id.instance == kNone && seen[at].id.instance == kNone) continue;
      ++compared;
      apart += id.instance != seen[at].id.instance || id.mesh != seen[at].id.mesh;
    }
  }
  EXPECT_GT(compared, 1000);
  return double(apart) / compared;
}

TEST(RayInTime, ExactForWhatGoesStraight) {
  const TriangleMesh world = soup(60, 0.4f, 20), first = ball({0, 0, 0}, 0.5f, 8, 0.2f),
                     second = soup(40, 0.4f, 21);
  EXPECT_LT(disagreement(world,
                         {{&first, translation({-1, 0, 0}), translation({1, 0.3, 0})},
                          {&second, kStill, translation({0, 0.7, -0.4})}},
                         nullptr, 22),
            0.002);
}

TEST(RayInTime, WhatTurnsAndGrowsIsFollowedInSteps) {
  const TriangleMesh world = soup(60, 0.4f, 23), first = plates(4, 0.2f), thin = needles(60, 24);
  EXPECT_LT(disagreement(world,
                         {{&first, kStill, scaling({1.5, 1, 0.8}) * turned(120, {0.3, 1, 0})},
                          {&thin, turned(5, {1, 0, 0}), turned(95, {1, 0, 0}) * translation({0.3, 0, 0})}},
                         nullptr, 25),
            0.02);
}

TEST(RayInTime, ACameraThatTurns) {
  const TriangleMesh world = soup(60, 0.4f, 26), first = ball({0, 0, 0}, 0.5f, 8);
  const auto camera = AnimatedTransform::between(translation({0, 0, 3}),
                                                 turned(25, {0, 1, 0}) * translation({1, 0, 3}), {0, 1});
  EXPECT_LT(disagreement(world, {{&first, translation({-1, 0, 0}), translation({1, 0, 0})}}, &*camera, 27),
            0.02);
}

TEST(RayInTime, AMotionThatBeginsLateAndEndsEarly) {
  const TriangleMesh world = soup(20, 0.4f, 28), one = ball({0, 0, 0}, 0.5f, 8);
  const auto motion = std::make_shared<const AnimatedTransform>(
      AnimatedTransform::between(translation({-1, 0, 0}), translation({1, 0, 0}), {-1, 2}).value());
  const Geometry moving = Geometry::build(std::vector<MeshInput>{{&world, {}, true}, {&one, {}, true}},
                                          std::vector<ObjectInput>{{1, 2}},
                                          std::vector<InstanceInput>{{0, motion->at(0), motion}}, 1)
                              .value();
  QueryCounters counters;
  std::vector<SeenInterval> seen;
  // The ball's rim of 0.5 (a polygon's) passes x = 0 from about t = 1/4 to 3/4 of its motion, which takes a
  // third of the time.
  moving.nearest(RayInTime{Vec3d(0, 0.01, 5), Vec3d(0, 0, -1), nullptr, {}}, seen, counters);
  double met = 0;
  for (const SeenInterval& interval : seen)
    if (interval.id.instance == 0) met += interval.hi - interval.lo;
  EXPECT_NEAR(met, 0.5 / 3, 0.02);
}

/// Bounds hold everything at all times.
TEST_F(Moving, BoundsAreThoseOfAllTimes) {
  const TriangleMesh world = soup(1, 0.1f, 14), one = ball({0, 0, 0}, 1, 8);
  const Geometry moving =
      build(world, {{&one, translation({-10, 0, 0}), translation({10, 0, 0})}}, std::nullopt);
  Vec3f lo, hi;
  moving.bounds(lo, hi);
  EXPECT_LE(lo.x, -10.9f);
  EXPECT_GE(hi.x, 10.9f);
}

}  // namespace
}  // namespace penumbra::testing

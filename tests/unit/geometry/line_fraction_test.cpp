// Near-degenerate scenes: the visible fraction of 2,000 chords against 4,096 rays each, and the same
// fractions when the scene is scaled or moved.
#include <gtest/gtest.h>

#include "tests/unit/geometry/hard_meshes.h"
#include "tests/unit/geometry/random_scenes.h"

namespace penumbra::testing {
namespace {

constexpr int kChords = 2000, kRays = 4096;

struct FractionCase {
  const char* name;
  TriangleMesh mesh;
};

std::vector<FractionCase> fraction_cases() {
  return {{"needles", needles(60, 51)}, {"plates", plates(12, 1e-6f)}, {"slats", slats(200)}};
}

class LineFraction : public ::testing::TestWithParam<FractionCase> {};

TEST_P(LineFraction, MatchesRays) {
  const FractionCase& c = GetParam();
  const MeshInput input{&c.mesh};
  const auto geometry = Geometry::build({&input, 1}, {}, {}, 2);
  ASSERT_TRUE(geometry.ok());
  Random random(52);
  QueryCounters counters;
  std::vector<IntervalSet> visible;
  double signed_sum = 0;
  int beyond = 0;
  for (int i = 0; i < kChords; ++i) {
    const LineQuery query = random_query(random);
    geometry->visible({&query, 1}, visible, counters);
    int lit = 0, changes = 0;
    bool before = true;
    for (int k = 0; k < kRays; ++k) {
      const float v = (static_cast<float>(k) + 0.5f) / kRays;
      const bool now = !geometry->occluded(query.x, query.a + (query.b - query.a) * v, counters);
      lit += now;
      changes += k > 0 && now != before;
      before = now;
    }
    // A change falls anywhere between two rays; a slit or a needle between two rays is missed by both, so
    // each end that the line found counts as well.
    const double ends = changes + 2.0 * static_cast<double>(visible[0].size());
    const double difference = visible[0].length() - static_cast<double>(lit) / kRays;
    signed_sum += difference;
    beyond += std::abs(difference) > (ends + 1) * 0.5 / kRays;
  }
  // The rays' grid is not biased: differences cancel.
  EXPECT_LT(std::abs(signed_sum) / kChords, 2e-5) << c.name;
  EXPECT_EQ(beyond, 0) << c.name;
  std::printf("%s: mean difference %.2e\n", c.name, signed_sum / kChords);
}

/// Coordinates on a grid of 1/64 in [-64,64]: moving them by a million of their units is exact up to 1/16, so
/// the grid is scaled to that.
Vec3f snapped(const Vec3f& p) {
  return {std::round(p.x * 1024) / 16, std::round(p.y * 1024) / 16, std::round(p.z * 1024) / 16};
}

TEST_P(LineFraction, StaysWhenTheSceneIsScaledOrMoved) {
  struct Change {
    const char* name;
    float scale;
    Vec3f move;
    double tolerance;  ///< of one chord's fraction
  };
  // A power of two changes no bit, a move by whole steps of the grid no difference of coordinates; other
  // scales round every input once.
  const Change changes[] = {{"2^-20", 0x1p-20f, {0, 0, 0}, 0},
                            {"2^20", 0x1p20f, {0, 0, 0}, 0},
                            {"1e-6", 1e-6f, {0, 0, 0}, 1e-3},
                            {"1e6", 1e6f, {0, 0, 0}, 1e-3},
                            {"moved 1e6", 1, {1e6f, -1e6f, 1e6f}, 1e-3}};
  FractionCase c = GetParam();
  for (Vec3f& p : c.mesh.positions) p = snapped(p);
  const LineBvh bvh = bvh_of({&c.mesh});
  for (const Change& change : changes) {
    const auto changed = [&](const Vec3f& p) { return p * change.scale + change.move; };
    TriangleMesh other = c.mesh;
    for (Vec3f& p : other.positions) p = changed(p);
    const LineBvh other_bvh = bvh_of({&other});
    Random random(53);
    double sum = 0;
    int apart = 0;
    for (int i = 0; i < kChords; ++i) {
      const LineQuery drawn = random_query(random);
      const LineQuery query{snapped(drawn.x), snapped(drawn.a), snapped(drawn.b)};
      const LineQuery moved{changed(query.x), changed(query.a), changed(query.b)};
      const double difference = std::abs(visible_by(bvh, widest_line_path(), query).length() -
                                         visible_by(other_bvh, widest_line_path(), moved).length());
      sum += difference;
      apart += difference > change.tolerance;
    }
    EXPECT_LE(apart, change.tolerance == 0 ? 0 : 2) << c.name << ", " << change.name;
    EXPECT_LE(sum / kChords, 1e-6) << c.name << ", " << change.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, LineFraction, ::testing::ValuesIn(fraction_cases()),
                         [](const auto& each) { return std::string(each.param.name); });

/// For the listing of tests.
void PrintTo(const FractionCase& c, std::ostream* out) {
  *out << c.name;
}

}  // namespace
}  // namespace penumbra::testing

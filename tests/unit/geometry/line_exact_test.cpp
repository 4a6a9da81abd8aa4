// 1e5 random chords per scene against every triangle in extended precision: each end of each visible interval
// lies within the battery's tolerance, 16 eps (1 + cond), of where it is.
#include <gtest/gtest.h>

#include "tests/unit/geometry/exact_lines.h"
#include "tests/unit/geometry/hard_meshes.h"
#include "tests/unit/geometry/random_scenes.h"

namespace penumbra::testing {
namespace {

constexpr int kQueries = 100000;

struct ExactCase {
  const char* name;
  TriangleMesh mesh;
  float scale = 1;
  Vec3f move{0, 0, 0};
};

std::vector<ExactCase> exact_cases() {
  std::vector<ExactCase> cases;
  cases.push_back({"few large", soup(30, 0.8f, 31)});
  cases.push_back({"many small", soup(150, 0.15f, 32)});
  cases.push_back({"needles", needles(60, 33)});
  cases.push_back({"stack", plates(12, 1e-6f)});
  cases.push_back({"blinds", slats(40)});
  cases.push_back({"ball", ball({0.1f, 0, -0.1f}, 0.6f, 6, 0.1f)});
  cases.push_back({"small", soup(40, 0.6f, 34), 1e-6f});
  cases.push_back({"large", soup(40, 0.6f, 35), 1e6f});
  cases.push_back({"far away", soup(40, 0.6f, 36), 8, {1e6f, -1e6f, 1e6f}});
  cases.push_back({"needles far away", needles(60, 37), 8, {1e6f, -1e6f, 1e6f}});
  return cases;
}

class LineExact : public ::testing::TestWithParam<ExactCase> {};

TEST_P(LineExact, EndsAreWithinTheTolerance) {
  ExactCase c = GetParam();
  for (Vec3f& p : c.mesh.positions) p = p * c.scale + c.move;
  const LineBvh bvh = bvh_of({&c.mesh});
  Random random(41);
  int doubtful = 0, partly = 0;
  for (int i = 0; i < kQueries; ++i) {
    LineQuery query = random_query(random);
    for (Vec3f* p : {&query.x, &query.a, &query.b}) *p = *p * c.scale + c.move;
    HiddenBounds bounds;
    const ExactChord chord(query);
    for (size_t t = 0; t < c.mesh.triangles(); ++t) {
      const uint32_t* index = &c.mesh.indices[3 * t];
      const Vec3f p[3] = {c.mesh.positions[index[0]], c.mesh.positions[index[1]], c.mesh.positions[index[2]]};
      chord.add(p, bounds);
    }
    const IntervalSet visible = visible_by(bvh, widest_line_path(), query);
    const Real wrong = contradiction(visible, bounds);
    ASSERT_LT(wrong, 0) << c.name << ", query " << i << ": wrong at " << static_cast<double>(wrong);
    doubtful += bounds.doubtful > 0;
    partly += visible.size() > 1 || (visible.size() == 1 && visible.length() < 1);
  }
  // The test must have judged something: few queries may be set aside, and many must have ends.
  EXPECT_LT(doubtful, kQueries / 20) << c.name;
  EXPECT_GT(partly, kQueries / 20) << c.name;
  std::printf("%-18s %d of %d chords partly visible, %d with a doubtful triangle\n", c.name, partly, kQueries,
              doubtful);
}

INSTANTIATE_TEST_SUITE_P(Scenes, LineExact, ::testing::ValuesIn(exact_cases()), [](const auto& each) {
  std::string name = each.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

/// For the listing of tests.
void PrintTo(const ExactCase& c, std::ostream* out) {
  *out << c.name;
}

}  // namespace
}  // namespace penumbra::testing

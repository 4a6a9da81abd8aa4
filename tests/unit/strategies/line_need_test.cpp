// Which mixes need the line hierarchy built before their clock starts.
#include "worker/strategies/line_need.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

bool needs(const char* mix, size_t lights) {
  LightSet set;
  set.delta.resize(lights);
  return needs_line_hierarchy(parse_mix(mix).value(), set);
}

TEST(LineNeed, PointsDoWithout) {
  EXPECT_FALSE(needs("bsdf:4", 1));
  EXPECT_FALSE(needs("bsdf:2+sa:2", 16));
  EXPECT_FALSE(needs("area:15", 1));
}

TEST(LineNeed, LinesRegionsAndWhatMayChooseThemDoNot) {
  EXPECT_TRUE(needs("bsdf:3+line-sa@v:1", 1));
  EXPECT_TRUE(needs("line-analytic@0:1", 1));
  EXPECT_TRUE(needs("bsdf:2+visible-area:2", 1));
  EXPECT_TRUE(needs("auto", 1));
}

/// Shafts serve many shadow rays to one light, also where one light may be drawn as often.
TEST(LineNeed, ManyShadowRaysAskAShaft) {
  EXPECT_TRUE(needs("area:16", 1));
  EXPECT_TRUE(needs("sa:10+area:6", 1));
  EXPECT_TRUE(needs("sa:1", 17));
}

/// Directions of the material cannot meet it: points stand for them, and those ask for shadow rays.
TEST(LineNeed, DirectionsTowardsAnInvisibleLightAreShadowRays) {
  LightSet set;
  set.area.resize(2, AreaEmitter{QuadShape{Vec3f(0), Vec3f(1, 0, 0), Vec3f(0, 1, 0)}, Rgb(1)});
  EXPECT_FALSE(needs_line_hierarchy(parse_mix("bsdf:16").value(), set));
  set.area[1].invisible = true;
  EXPECT_TRUE(needs_line_hierarchy(parse_mix("bsdf:16").value(), set));
  EXPECT_TRUE(needs_line_hierarchy(parse_mix("bsdf:8+sa:8").value(), set));
  EXPECT_FALSE(needs_line_hierarchy(parse_mix("bsdf:8+sa:7").value(), set));
}

}  // namespace
}  // namespace penumbra

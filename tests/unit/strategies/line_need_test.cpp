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

}  // namespace
}  // namespace penumbra

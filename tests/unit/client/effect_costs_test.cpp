#include "client/effect_costs.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

TEST(EffectCosts, RatiosAreOfTheSameRound) {
  // The machine is twice as slow in the second round: that is no matter of the effect.
  const EffectCost cost = effect_cost("lens", {{1.2, 5}, {2.4, 6}, {1.3, 7}}, {{1, 1}, {2, 2}, {1, 3}});
  EXPECT_EQ(cost.effect, "lens");
  EXPECT_DOUBLE_EQ(cost.ratio, 1.2);
  EXPECT_DOUBLE_EQ(cost.least, 1.2);
  EXPECT_DOUBLE_EQ(cost.most, 1.3);
  EXPECT_DOUBLE_EQ(cost.pass_seconds, 1.3);
  EXPECT_DOUBLE_EQ(cost.pass_seconds_without, 1);
  EXPECT_DOUBLE_EQ(cost.load_seconds, 6);
  EXPECT_DOUBLE_EQ(cost.load_seconds_without, 2);
  EXPECT_DOUBLE_EQ(effect_cost("lens", {{1, 1}, {3, 1}}, {{1, 1}, {1, 1}}).ratio, 2) << "of an even number";
}

}  // namespace
}  // namespace penumbra

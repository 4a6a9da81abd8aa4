#include "proto/mix.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/status.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

TEST(Mix, ALensOfLinesStandsAfterTheCombination) {
  const auto mix = parse_mix("bsdf:2+sa:2/balance/lens=line");
  ASSERT_TRUE(mix.ok());
  EXPECT_EQ(mix->lens, LensSampling::kLine);
  EXPECT_EQ(label(*mix), "bsdf:2+sa:2/balance/lens=line");
  EXPECT_EQ(file_stem(label(*mix)), "bsdf-2+sa-2_balance_lens-line");
}

TEST(Mix, MotionByLinesStandsBesideTheOtherEffects) {
  const auto mix = parse_mix("sa:2/motion=line/lens=line");
  ASSERT_TRUE(mix.ok());
  EXPECT_EQ(mix->motion, MotionSampling::kLine);
  EXPECT_EQ(mix->lens, LensSampling::kLine);
  EXPECT_EQ(label(*mix), "sa:2/balance/lens=line/motion=line");
  EXPECT_EQ(parse_mix("sa:2/motion=point")->motion, MotionSampling::kPoint);
}

TEST(Mix, TheNormalFormSaysNothingOfPointsOnTheLens) {
  for (const char* text : {"sa", "sa:1/lens=point", "sa/balance", "sa:1/balance/lens=point"}) {
    const auto mix = parse_mix(text);
    ASSERT_TRUE(mix.ok()) << text;
    EXPECT_EQ(label(*mix), "sa:1/balance");
  }
}

TEST(Mix, LabelsAreReadBack) {
  for (const char* text :
       {"sa/lens=line", "sa/motion=line", "sa:2/free/pixel=line", "bsdf+line-sa@v:3/smooth=0.25/lens=line",
        "sa+area/average/lens=line", "line-area@33.5:2/smooth-ease=auto", "bsdf:1/free"}) {
    const auto mix = parse_mix(text);
    ASSERT_TRUE(mix.ok()) << text;
    const auto again = parse_mix(label(*mix));
    ASSERT_TRUE(again.ok()) << label(*mix);
    EXPECT_EQ(*again, *mix);
  }
}

TEST(Mix, FaultsNameTheWord) {
  const std::pair<const char*, const char*> faults[] = {
      {"sa/motion=curve", "'curve'"},
      {"sa/pixel=area", "pixel=point or pixel=line"},
      {"sa/lens=plane", "'plane'"},
      {"sa/lens=", "lens=point or lens=line"},
      {"sa/lens=line/balance", "'balance'"},
      {"sa/balance/power", "'power'"},
      {"sa/", "unknown combination"},
      {"sa/balance/", "after the combination"},
      {"auto/lens=line", "'auto'"},
      {"sa/motion=line/motion=point", "motion= stands twice"},
      {"sa/lens=line/medium=line/lens=line", "lens= stands twice"}};
  for (const auto& [text, message] : faults) {
    const auto mix = parse_mix(text);
    ASSERT_FALSE(mix.ok()) << text;
    EXPECT_THAT(message_of(mix.status()), HasSubstr(message)) << text;
  }
}

TEST(Mix, HasNoMoreStrategiesThanItsNormalFormHasRoomFor) {
  std::string text = "sa";
  for (int i = 1; i < 64; ++i) text += "+sa";
  EXPECT_TRUE(parse_mix(text).ok());
  EXPECT_THAT(message_of(parse_mix(text + "+sa").status()), HasSubstr("more than 64 strategies"));
}

}  // namespace
}  // namespace penumbra

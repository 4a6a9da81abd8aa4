#include "client/pointline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes.h"

namespace penumbra {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::string scene(const std::string& integrator, int x = 2, int y = 2) {
  return "Integrator \"pointline\" " + integrator +
         "\nWorldBegin\nAttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"integer xsamples\" "
         "[" +
         std::to_string(x) + "] \"integer ysamples\" [" + std::to_string(y) +
         "]\nShape \"quad\" \"point o\" [0 0 0] \"vector u\" [1 0 0] \"vector v\" [0 1 "
         "0]\nAttributeEnd\nWorldEnd\n";
}

std::string mix_of(const std::string& text) {
  std::vector<std::string> notes;
  const auto mix = pointline_mix(parsed(text), notes);
  EXPECT_TRUE(mix.ok()) << message_of(mix.status());
  EXPECT_THAT(notes, IsEmpty());
  return mix.ok() ? label(*mix) : "";
}

TEST(Pointline, ThePapersThreeScenes) {
  // cornell-box, op-veach, kitchen: their Integrator lines, their lights' sample counts.
  EXPECT_EQ(mix_of(scene("\"string strategy1\" [\"line-surf-area\"] \"float angle1\" [0.0] "
                         "\"string strategy2\" [\"line-surf-area\"] \"float angle2\" [0.5]",
                         1, 1)),
            "line-area@90:1+line-area@0:1/balance");
  EXPECT_EQ(
      mix_of(scene(
          "\"string strategy1\" [\"brdf\"] \"string strategy2\" [\"line-solid-angle\"] \"float angle2\" [1]",
          1, 1)),
      "bsdf:1+line-sa@v:1/balance");
  EXPECT_EQ(
      mix_of(scene(
          "\"string strategy1\" [\"brdf\"] \"string strategy2\" [\"line-solid-angle\"] \"float angle2\" [1] "
          "\"bool stratified\" [\"true\"]")),
      "bsdf:2+line-sa@v:2/balance");
}

TEST(Pointline, ASingleStrategyGetsAllSamples) {
  EXPECT_EQ(mix_of(scene("\"string strategy1\" [\"brdf\"]")), "bsdf:4/balance");
  EXPECT_EQ(mix_of(scene("\"string strategy1\" [\"pt-surf-area\"]", 3, 3)), "area:9/balance");
  EXPECT_EQ(mix_of(scene("\"string strategy1\" [\"pt-solid-angle\"]", 1, 1)), "sa:1/balance");
  EXPECT_EQ(mix_of(scene("\"string strategy1\" [\"line-solid-angle\"]", 1, 1)), "line-sa@u:1/balance");
}

TEST(Pointline, RatioSharesOut) {
  const std::string two =
      "\"string strategy1\" [\"brdf\"] \"string strategy2\" [\"line-solid-angle\"] \"float angle2\" [1] ";
  EXPECT_EQ(mix_of(scene(two)), "bsdf:2+line-sa@v:2/balance");
  EXPECT_EQ(mix_of(scene(two + "\"float ratio\" [0.75]")), "bsdf:3+line-sa@v:1/balance");
  EXPECT_EQ(mix_of(scene(two + "\"float ratio\" [0.3]")), "bsdf:1+line-sa@v:3/balance");
  EXPECT_EQ(mix_of(scene(two + "\"float ratio\" [1]")), "bsdf:4/balance");
  EXPECT_EQ(mix_of(scene(two + "\"float ratio\" [0]")), "line-sa@v:4/balance");
  EXPECT_EQ(mix_of(scene(two + "\"float ratio\" [0.75] \"bool stratified\" [\"true\"]")),
            "bsdf:2+line-sa@v:2/balance");
  EXPECT_EQ(mix_of(scene("\"string strategy1\" [\"brdf\"] \"string strategy2\" [\"pt-solid-angle\"] "
                         "\"string strategy3\" [\"line-solid-angle\"] \"float ratio\" [0.3]",
                         3, 3)),
            "bsdf:3+sa:3+line-sa@u:3/balance");
}

TEST(Pointline, CombinationsFollowTheirFlags) {
  const std::string two =
      "\"string strategy1\" [\"pt-surf-area\"] \"string strategy2\" [\"line-surf-area\"] \"float angle2\" "
      "[0.25] ";
  EXPECT_EQ(mix_of(scene(two + "\"bool mis\" [\"false\"]", 1, 1)), "area:1+line-area@135:1/average");
  EXPECT_EQ(mix_of(scene(two + "\"float smoothstep\" [0.1]", 1, 1)), "area:1+line-area@135:1/smooth=0.1");
}

TEST(Pointline, FaultsNameTheirPlace) {
  std::vector<std::string> notes;
  const auto fault = [&](const std::string& integrator) {
    const auto mix = pointline_mix(parsed(scene(integrator)), notes);
    EXPECT_FALSE(mix.ok()) << integrator;
    return message_of(mix.status());
  };
  EXPECT_THAT(fault("\"string strategy1\" [\"brdv\"]"), HasSubstr("s.pbrt:1:"));
  EXPECT_THAT(fault("\"string strategy1\" [\"brdv\"]"), HasSubstr("unknown strategy 'brdv'"));
  EXPECT_THAT(fault("\"string strategy1\" [\"line-solid-angle\"] \"float angle1\" [0.5]"),
              HasSubstr("angle1 0.5"));
  EXPECT_THAT(fault("\"string strategy1\" [\"line-surf-area\"] \"float angle1\" [1.5]"),
              HasSubstr("angle1 1.5"));
  EXPECT_THAT(fault(""), HasSubstr("names no strategy"));
  EXPECT_THAT(fault("\"string strategy1\" [\"brdf\"] \"float smoothstep\" [-1]"), HasSubstr("smoothstep -1"));
}

TEST(Pointline, WhatIsNotLiteralIsSaid) {
  std::vector<std::string> notes;
  const auto mix =
      pointline_mix(parsed(scene("\"string strategy1\" [\"brdf\"] \"string strategy2\" [\"pt-surf-area\"] "
                                 "\"float smoothstep\" [0.2]")),
                    notes);
  ASSERT_TRUE(mix.ok());
  EXPECT_EQ(label(*mix), "bsdf:2+area:2/balance");
  ASSERT_THAT(notes, SizeIs(1));
  EXPECT_THAT(notes[0], HasSubstr("smoothstep without a line strategy"));
}

}  // namespace
}  // namespace penumbra

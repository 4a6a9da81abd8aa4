#include "client/parse_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/status.h"

namespace penumbra {
namespace {

using testing::StartsWith;

template <class Value>
void expect_fault(const absl::StatusOr<Value>& value, const std::string& text) {
  ASSERT_FALSE(value.ok()) << text;
  EXPECT_EQ(value.status().code(), absl::StatusCode::kInvalidArgument) << text;
  EXPECT_THAT(message_of(value.status()), StartsWith("--flag: ")) << text;
}

TEST(Durations, HaveUnits) {
  EXPECT_DOUBLE_EQ(*parse_duration("--flag", "500ms"), 0.5);
  EXPECT_DOUBLE_EQ(*parse_duration("--flag", "30s"), 30);
  EXPECT_DOUBLE_EQ(*parse_duration("--flag", "2m"), 120);
  EXPECT_DOUBLE_EQ(*parse_duration("--flag", "1.5s"), 1.5);
  EXPECT_DOUBLE_EQ(*parse_duration("--flag", "1h"), 3600);
}

TEST(Durations, MustBeMoreThanNothing) {
  for (const char* text :
       {"", "30", "s", "0s", "-3s", "0ms", "1e999s", "nans", "infs", "3 s", "3sec", "0x5s", " 3s"})
    expect_fault(parse_duration("--flag", text), text);
}

TEST(Resolutions, AreTwoPositiveNumbers) {
  const auto r = parse_resolution("--flag", "640x360");
  ASSERT_TRUE(r.ok());
  EXPECT_EQ(r->width, 640);
  EXPECT_EQ(r->height, 360);
  for (const char* text : {"", "x", "640", "640x", "x360", "0x5", "5x0", "-1x5", "640x360x2", "640*360",
                           "65537x1", "65536x65536", "99999999999x1", "6.4e2x3"})
    expect_fault(parse_resolution("--flag", text), text);
}

TEST(Rectangles, AreHalfOpenAndNotEmpty) {
  EXPECT_EQ(*parse_rect("--flag", "1,2,3,4"), (PixelRect{1, 2, 3, 4}));
  for (const char* text : {"", "1,2,3", "1,2,3,4,5", "1,2,3,", "1,2,1,4", "3,2,1,4", "1,4,3,4", "-1,0,3,3",
                           "a,b,c,d", "0,0,70000,5", "1 ,2,3,4"})
    expect_fault(parse_rect("--flag", text), text);
}

TEST(Regions, HaveNames) {
  const auto region = parse_region("--flag", "green table=1,2,3,4");
  ASSERT_TRUE(region.ok());
  EXPECT_EQ(region->name, "green table");
  for (const char* text : {"1,2,3,4", "=1,2,3,4", "a=", "a=1,2,3", "a"})
    expect_fault(parse_region("--flag", text), text);
}

TEST(Numbers, AreWholeAndInRange) {
  EXPECT_EQ(*parse_whole("--flag", "16", 1, 100), 16);
  for (const char* text : {"0", "101", "-1", "1.5", "", "16x", "9999999999999999999999"})
    expect_fault(parse_whole("--flag", text, 1, 100), text);
  EXPECT_EQ(*parse_seed("--flag", "18446744073709551615"), 18446744073709551615u);
  for (const char* text : {"-1", "18446744073709551616", "x", ""})
    expect_fault(parse_seed("--flag", text), text);
  EXPECT_EQ(*parse_positive("--flag", "1e-3"), 1e-3);
  for (const char* text : {"0", "-1", "inf", "nan", "", "1e400"})
    expect_fault(parse_positive("--flag", text), text);
}

TEST(Percentages, HaveTheirSign) {
  EXPECT_DOUBLE_EQ(*parse_percent("--flag", "5%"), 0.05);
  EXPECT_DOUBLE_EQ(*parse_percent("--flag", "0.3%"), 0.003);
  for (const char* text : {"5", "%", "", "-5%", "0%", "nan%", "5 %", "5%%"})
    expect_fault(parse_percent("--flag", text), text);
}

TEST(Pixels, AreTwoWholeNumbers) {
  EXPECT_EQ(parse_pixel("--flag", "128,0")->x, 128);
  for (const char* text : {"128", "1,2,3", "-1,2", "1,-2", "a,b", ",", ""})
    expect_fault(parse_pixel("--flag", text), text);
}

TEST(Samplers, RoundTripTheirNames) {
  for (const SamplerKind kind : {SamplerKind::kIndependent, SamplerKind::kStratified, SamplerKind::kSobol})
    EXPECT_EQ(*parse_sampler("--flag", name_of(kind)), kind);
  expect_fault(parse_sampler("--flag", "halton"), "halton");
}

}  // namespace
}  // namespace penumbra

// How media are lit, as the last word of a mix.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/mix.h"

namespace penumbra {
namespace {

TEST(MediumMix, IsReadAndWrittenOnlyWhereItIsLines) {
  const auto line = parse_mix("sa:2/medium=line");
  ASSERT_TRUE(line.ok()) << line.status();
  EXPECT_EQ(line->medium, MediumSampling::kLine);
  EXPECT_EQ(label(*line), "sa:2/balance/medium=line");
  EXPECT_EQ(*parse_mix(label(*line)), *line);
  EXPECT_EQ(label(*parse_mix("sa:2/power/medium=point")), "sa:2/power");
  EXPECT_EQ(file_stem(label(*line)), "sa-2_balance_medium-line");
}

TEST(MediumMix, AnythingElseNamesTheWord) {
  const auto message = [](const char* text) { return std::string(parse_mix(text).status().message()); };
  EXPECT_THAT(message("sa/medium=lines"), testing::HasSubstr("'lines'"));
  EXPECT_THAT(message("sa/medium=line/power"), testing::HasSubstr("must stand last"));
  EXPECT_THAT(message("sa/balance/power"), testing::HasSubstr("'power'"));
}

}  // namespace
}  // namespace penumbra

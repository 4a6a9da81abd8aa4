#include "proto/wire_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace penumbra {
namespace {

using testing::ElementsAre;

TEST(WireText, KeepsWhatIsUtf8AndMarksWhatIsNot) {
  EXPECT_EQ(wire_text("fen\xC3\xAAtre \xE2\x82\xAC \xF0\x9F\x92\xA1", 100),
            "fen\xC3\xAAtre \xE2\x82\xAC \xF0\x9F\x92\xA1");
  EXPECT_EQ(wire_text("n\xE4me", 100), "n?me") << "Latin-1";
  EXPECT_EQ(wire_text("\xC0\x80|\xE0\x80\x80|\xF0\x80\x80\x80", 100), "??|???|????") << "overlong";
  EXPECT_EQ(wire_text("\xED\xA0\x80", 100), "???") << "a surrogate";
  EXPECT_EQ(wire_text("\xF4\x90\x80\x80", 100), "????") << "beyond U+10FFFF";
  EXPECT_EQ(wire_text("a\xE2\x82", 100), "a??") << "cut off";
}

TEST(WireText, CutsBetweenCharacters) {
  EXPECT_EQ(wire_text("1234567890", 10), "1234567890");
  EXPECT_EQ(wire_text("12345678901", 10), "1234567…");
  EXPECT_EQ(wire_text("123456\xE2\x82\xAC\xE2\x82\xAC", 10), "123456…") << "no half a character";
  for (size_t most = 3; most < 20; ++most)
    EXPECT_LE(
        wire_text("\xE2\x82\xAC\xE2\x82\xAC\xE2\x82\xAC\xE2\x82\xAC\xE2\x82\xAC\xE2\x82\xAC", most).size(),
        most);
}

TEST(WireTexts, SaysHowManyAreLeftOut) {
  EXPECT_THAT(wire_texts({"one", "two", "three", "four"}, 10, 8), ElementsAre("one", "two", "and 2 more"));
  EXPECT_THAT(wire_texts({"one", "two"}, 10, 6), ElementsAre("one", "two"));
}

}  // namespace
}  // namespace penumbra

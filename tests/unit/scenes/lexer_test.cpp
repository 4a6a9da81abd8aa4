#include "scenes/lexer.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace penumbra {
namespace {

using Kind = Token::Kind;
using testing::ElementsAre;

std::vector<std::string> texts(std::string_view text) {
  Lexer lexer(text, 0);
  std::vector<std::string> out;
  for (;;) {
    const Token token = lexer.next();
    if (token.kind == Kind::kEnd) return out;
    if (token.kind == Kind::kError) return {"error", std::string(token.text)};
    out.emplace_back(token.kind == Kind::kString ? fmt::format("'{}'", token.text) : std::string(token.text));
  }
}

TEST(Lexer, NeedsNoBlanksBetweenTokens) {
  EXPECT_THAT(texts("Shape\"sphere\"\"float radius\"[1]"),
              ElementsAre("Shape", "'sphere'", "'float radius'", "[", "1", "]"));
}

TEST(Lexer, CommentsEndAtTheLineAndStayOutOfStrings) {
  EXPECT_THAT(texts("[6500 100 ] #\"color L\"\nTexture \"Map #0\" # \"x\n\"y\""),
              ElementsAre("[", "6500", "100", "]", "Texture", "'Map #0'", "'y'"));
  EXPECT_THAT(texts("a#no newline at the end"), ElementsAre("a"));
}

TEST(Lexer, AcceptsEveryLineEndAndTheByteOrderMark) {
  EXPECT_THAT(texts("\xEF\xBB\xBF"
                    "a\r\nb\tc\r\n"),
              ElementsAre("a", "b", "c"));
}

TEST(Lexer, CountsLinesAndColumnsFromOne) {
  Lexer lexer("a\n  b # c\n\n[\"d e\"", 7);
  EXPECT_EQ(lexer.next().loc.line, 1u);
  const FileLoc b = lexer.next().loc;
  EXPECT_EQ(b.file, 7u);
  EXPECT_EQ(b.line, 2u);
  EXPECT_EQ(b.column, 3u);
  EXPECT_EQ(lexer.next().loc.line, 4u);
  EXPECT_EQ(lexer.next().loc.column, 2u);
}

TEST(Lexer, RefusesUnterminatedStringsAndControlCharacters) {
  EXPECT_THAT(texts("\"abc"), ElementsAre("error", testing::HasSubstr("closing quote")));
  EXPECT_THAT(texts("\"abc\n\""), ElementsAre("error", testing::HasSubstr("closing quote")));
  EXPECT_THAT(texts("\"abc\\"), ElementsAre("error", testing::HasSubstr("closing quote")));
  EXPECT_THAT(texts(std::string_view("a \0 b", 5)),
              ElementsAre("error", testing::HasSubstr("control character")));
  EXPECT_THAT(texts("\x01"), ElementsAre("error", testing::HasSubstr("control character")));
}

TEST(Lexer, AnEscapedQuoteDoesNotEndAString) {
  EXPECT_THAT(texts(R"("a\"b" c)"), ElementsAre(R"('a\"b')", "c"));
}

TEST(Unescape, KnowsPbrtsEscapesAndKeepsOtherBackslashes) {
  EXPECT_EQ(unescape(R"(a\"b\\c\n)"), "a\"b\\c\n");
  EXPECT_EQ(unescape(R"(..\sourceimages\)"), R"(..\sourceimages\)");
}

TEST(ParseNumber, ReadsWhatPbrtFilesContain) {
  EXPECT_EQ(parse_number(".5"), 0.5);
  EXPECT_EQ(parse_number("-2."), -2.0);
  EXPECT_EQ(parse_number("+3"), 3.0);
  EXPECT_EQ(parse_number("1e-5"), 1e-5);
  EXPECT_EQ(parse_number("1.86265e-009"), 1.86265e-9);
  EXPECT_EQ(parse_number("1e-400"), 0.0);
  EXPECT_TRUE(std::isinf(*parse_number("1e400")));
  EXPECT_TRUE(std::isnan(*parse_number("nan")));
}

TEST(ParseNumber, RefusesEverythingElse) {
  for (const char* const text : {"", "+", "-", "1x", "0x10", "+-1", "--1", "1,2", "."})
    EXPECT_FALSE(parse_number(text)) << text;
}

}  // namespace
}  // namespace penumbra

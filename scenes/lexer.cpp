#include "scenes/lexer.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace penumbra {
namespace {

enum class CharClass : uint8_t { kWord, kBlank, kQuote, kOpen, kClose, kHash, kBinary };

constexpr std::array<CharClass, 256> make_classes() {
  std::array<CharClass, 256> classes{};
  for (int c = 0; c < 0x20; ++c) classes[c] = CharClass::kBinary;
  classes[0x7f] = CharClass::kBinary;
  for (const char c : {' ', '\t', '\r', '\n', '\v', '\f'}) classes[c] = CharClass::kBlank;
  classes['"'] = CharClass::kQuote;
  classes['['] = CharClass::kOpen;
  classes[']'] = CharClass::kClose;
  classes['#'] = CharClass::kHash;
  return classes;
}

constexpr std::array<CharClass, 256> kClasses = make_classes();

CharClass class_of(char c) {
  return kClasses[static_cast<unsigned char>(c)];
}

}  // namespace

Lexer::Lexer(std::string_view text, uint32_t file)
    : at_(text.data()), end_(text.data() + text.size()), line_start_(text.data()), file_(file) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) at_ += kByteOrderMark.size();
}

FileLoc Lexer::here() const {
  return {file_, line_, static_cast<uint32_t>(at_ - line_start_ + 1)};
}

Token Lexer::error(std::string_view what) const {
  return {Token::Kind::kError, what, here()};
}

void Lexer::skip_blanks() {
  for (; at_ != end_; ++at_) {
    const CharClass c = class_of(*at_);
    if (c == CharClass::kHash) {
      const void* eol = std::memchr(at_, '\n', end_ - at_);
      if (!eol) {
        at_ = end_;
        return;
      }
      at_ = static_cast<const char*>(eol);
    } else if (c != CharClass::kBlank) {
      return;
    }
    if (*at_ == '\n') {
      ++line_;
      line_start_ = at_ + 1;
    }
  }
}

Token Lexer::next() {
  skip_blanks();
  if (at_ == end_) return {Token::Kind::kEnd, {}, here()};
  const Token bracket{Token::Kind::kOpen, {at_, 1}, here()};
  switch (class_of(*at_)) {
    case CharClass::kQuote:
      return string_token();
    case CharClass::kOpen:
      ++at_;
      return bracket;
    case CharClass::kClose:
      ++at_;
      return {Token::Kind::kClose, bracket.text, bracket.loc};
    case CharClass::kBinary:
      return error("a control character: this is not a scene's text");
    default:
      return word_token();
  }
}

Token Lexer::string_token() {
  const FileLoc start = here();
  const char* const first = ++at_;
  for (; at_ != end_; ++at_) {
    if (*at_ == '"') return {Token::Kind::kString, {first, static_cast<size_t>(at_++ - first)}, start};
    if (*at_ == '\n') break;
    if (*at_ == '\\' && at_ + 1 != end_ && at_[1] != '\n') ++at_;
  }
  return {Token::Kind::kError, "this string has no closing quote on its line", start};
}

Token Lexer::word_token() {
  const FileLoc start = here();
  const char* const first = at_;
  while (at_ != end_ && class_of(*at_) == CharClass::kWord) ++at_;
  return {Token::Kind::kWord, {first, static_cast<size_t>(at_ - first)}, start};
}

std::string unescape(std::string_view raw) {
  std::string out;
  out.reserve(raw.size());
  for (size_t i = 0; i < raw.size(); ++i) {
    if (raw[i] != '\\' || i + 1 == raw.size()) {
      out += raw[i];
      continue;
    }
    constexpr std::string_view kLetters = "bfnrt\\'\"";
    constexpr std::string_view kMeanings = "\b\f\n\r\t\\'\"";
    if (const size_t k = kLetters.find(raw[i + 1]); k != std::string_view::npos) {
      out += kMeanings[k];
      ++i;
    } else {
      out += '\\';
    }
  }
  return out;
}

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, fault] = std::from_chars(text.data(), end, value);
  if (rest != end) return std::nullopt;
  if (fault == std::errc()) return value;
  if (fault != std::errc::result_out_of_range) return std::nullopt;
  // from_chars does not say on which side: strtod does (±infinity, or a number near 0).
  return std::strtod(std::string(text).c_str(), nullptr);
}

}  // namespace penumbra

#pragma once
// From the bytes of one scene file to its tokens. Copies nothing: tokens are views of the text.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "scenes/description.h"

namespace penumbra {

struct Token {
  enum class Kind : uint8_t {
    kWord,    ///< a directive, a number, or a bare true/false
    kString,  ///< text: what stands between the quotes, escapes not yet decoded
    kOpen,    ///< [
    kClose,   ///< ]
    kEnd,     ///< the text is over
    kError,   ///< text: what is wrong here; nothing follows
  };
  Kind kind = Kind::kEnd;
  std::string_view text;
  FileLoc loc;
};

/// Blanks, line ends of any system and `#` comments separate tokens; a `#` inside quotes is a letter.
/// Quotes and brackets need no blanks around them. Linear in the text's length.
class Lexer {
 public:
  Lexer(std::string_view text, uint32_t file);
  Token next();

 private:
  void skip_blanks();
  FileLoc here() const;
  Token error(std::string_view what) const;
  Token string_token();
  Token word_token();

  const char* at_;
  const char* end_;
  const char* line_start_;
  uint32_t line_ = 1;
  uint32_t file_;
};

/// Decodes the escapes that pbrt knows (\b \f \n \r \t \\ \' \"). Any other backslash stays as it is:
/// it belongs to a path from Windows.
std::string unescape(std::string_view raw);

/// The whole of `text` as a decimal number; also with a leading `+`. Empty if it is something else.
/// A magnitude beyond double's range gives an infinity, `nan` and `inf` what they say: whether a number
/// is finite is for the caller to judge, who knows the place.
std::optional<double> parse_number(std::string_view text);

}  // namespace penumbra

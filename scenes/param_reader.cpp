#include "scenes/param_reader.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace penumbra {
namespace {

enum class Values { kNumbers, kIntegers, kStrings, kBools, kSpectrum };

struct Type {
  std::string_view written, normalised;
  Values values;
  size_t arity;  ///< numbers come in groups of this many
};

constexpr Type kTypes[] = {
    {"float", "float", Values::kNumbers, 1},
    {"integer", "integer", Values::kIntegers, 1},
    {"bool", "bool", Values::kBools, 1},
    {"string", "string", Values::kStrings, 1},
    {"texture", "texture", Values::kStrings, 1},
    {"point", "point3", Values::kNumbers, 3},
    {"point2", "point2", Values::kNumbers, 2},
    {"point3", "point3", Values::kNumbers, 3},
    {"vector", "vector3", Values::kNumbers, 3},
    {"vector2", "vector2", Values::kNumbers, 2},
    {"vector3", "vector3", Values::kNumbers, 3},
    {"normal", "normal", Values::kNumbers, 3},
    {"normal3", "normal", Values::kNumbers, 3},
    {"rgb", "rgb", Values::kNumbers, 3},
    {"color", "rgb", Values::kNumbers, 3},
    {"xyz", "xyz", Values::kNumbers, 3},
    {"blackbody", "blackbody", Values::kNumbers, 1},
    {"spectrum", "spectrum", Values::kSpectrum, 1},
};

const Type* find_type(std::string_view word) {
  for (const Type& type : kTypes)
    if (type.written == word) return &type;
  return nullptr;
}

constexpr std::string_view kBlanks = " \t";

std::string_view take_word(std::string_view& text) {
  const size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) {
    text = {};
    return {};
  }
  text.remove_prefix(begin);
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

/// Splits `type name` (blanks and tabs anywhere around both).
absl::StatusOr<const Type*> read_declaration(const Token& token, Param& param,
                                             const Diagnostics& diagnostics) {
  const std::string declaration = unescape(token.text);
  std::string_view rest = declaration;
  const std::string_view type_word = take_word(rest);
  const std::string_view name = take_word(rest);
  if (name.empty() || rest.find_first_not_of(kBlanks) != std::string_view::npos)
    return diagnostics.error(token.loc, "expected a parameter as \"type name\", found \"{}\"",
                             printable(declaration));
  const Type* const type = find_type(type_word);
  if (!type)
    return diagnostics.error(token.loc, "unknown parameter type '{}' in \"{}\"", printable(type_word),
                             printable(declaration));
  param.type = type->normalised;
  param.name = name;
  param.loc = token.loc;
  return type;
}

/// `cut`: whether a number of this parameter was no whole one.
absl::Status add_number(const Token& token, const Type& type, Param& param, bool& cut,
                        Diagnostics& diagnostics) {
  ASSIGN_OR_RETURN(double value, number_of(token, diagnostics));
  if (type.values == Values::kIntegers) {
    if (value < std::numeric_limits<int32_t>::min() || value > std::numeric_limits<int32_t>::max())
      return diagnostics.error(token.loc, "'{}' does not fit an integer of 32 bits", token.text);
    if (value != std::trunc(value)) {
      if (!std::exchange(cut, true))  // once for all of them: meshes have many
        diagnostics.warn(token.loc, "\"integer {}\": {} is cut to {}", printable(param.name), value,
                         std::trunc(value));
      value = std::trunc(value);
    }
  }
  param.numbers.push_back(value);
  return absl::OkStatus();
}

absl::Status add_bool(const Token& token, Param& param, const Diagnostics& diagnostics) {
  if (token.text != "true" && token.text != "false")
    return diagnostics.error(token.loc, "'{}' is neither true nor false", printable(token.text));
  param.bools.push_back(token.text == "true");
  return absl::OkStatus();
}

absl::Status add_value(const Token& token, const Type& type, Param& param, bool& cut,
                       Diagnostics& diagnostics) {
  const bool quoted = token.kind == Token::Kind::kString;
  if (!quoted && token.kind != Token::Kind::kWord)
    return diagnostics.error(token.loc, "parameter \"{} {}\" has no value", param.type,
                             printable(param.name));
  switch (type.values) {
    case Values::kBools:
      return add_bool(token, param, diagnostics);
    case Values::kNumbers:
    case Values::kIntegers:
      if (quoted)
        return diagnostics.error(token.loc, "\"{} {}\" takes numbers, not \"{}\"", param.type,
                                 printable(param.name), printable(token.text));
      return add_number(token, type, param, cut, diagnostics);
    case Values::kStrings:
    case Values::kSpectrum:
      if (quoted) {
        param.strings.push_back(unescape(token.text));
        return absl::OkStatus();
      }
      if (type.values == Values::kSpectrum) return add_number(token, type, param, cut, diagnostics);
      return diagnostics.error(token.loc, "\"{} {}\" takes a quoted value, not {}", param.type,
                               printable(param.name), printable(token.text));
  }
  PENUMBRA_CHECK(false);
}

absl::Status read_values(TokenStream& tokens, const Type& type, Param& param, Diagnostics& diagnostics) {
  Token token = tokens.next();
  bool cut = false;
  if (token.kind == Token::Kind::kError) return tokens.status();
  if (token.kind != Token::Kind::kOpen) return add_value(token, type, param, cut, diagnostics);
  const FileLoc opened = token.loc;
  for (;;) {
    token = tokens.next();
    if (token.kind == Token::Kind::kClose) return absl::OkStatus();
    if (token.kind == Token::Kind::kError) return tokens.status();
    if (token.kind == Token::Kind::kEnd)
      return diagnostics.error(opened, "this [ is never closed: the text ends inside \"{} {}\"", param.type,
                               printable(param.name));
    RETURN_IF_ERROR(add_value(token, type, param, cut, diagnostics));
  }
}

/// Numbers in whole groups. pbrt drops what is left over and says so; we do the same, but insist on one
/// whole group.
absl::Status check_arity(const Type& type, Param& param, Diagnostics& diagnostics) {
  if (type.values == Values::kSpectrum && !param.numbers.empty() && !param.strings.empty())
    return diagnostics.error(param.loc, "\"spectrum {}\" mixes numbers and names", printable(param.name));
  const size_t excess = param.numbers.size() % type.arity;
  if (excess == 0) return absl::OkStatus();
  if (param.numbers.size() < type.arity)
    return diagnostics.error(param.loc, "\"{} {}\" takes {} numbers, found {}", param.type,
                             printable(param.name), type.arity, param.numbers.size());
  diagnostics.warn(param.loc, "\"{} {}\": {} numbers are no multiple of {}; the last {} left out", param.type,
                   printable(param.name), param.numbers.size(), type.arity, excess);
  param.numbers.resize(param.numbers.size() - excess);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<double> number_of(const Token& token, const Diagnostics& diagnostics) {
  const auto value = parse_number(token.text);
  if (!value) return diagnostics.error(token.loc, "expected a number, found '{}'", printable(token.text));
  if (std::isnan(*value)) return diagnostics.error(token.loc, "'{}' is not a number", token.text);
  // Geometry and colours are floats in the end: what overflows there is refused here, with its place.
  if (!(std::abs(*value) <= std::numeric_limits<float>::max()))
    return diagnostics.error(token.loc, "'{}' is not finite in single precision", printable(token.text));
  return *value;
}

absl::StatusOr<double> read_number(TokenStream& tokens, Diagnostics& diagnostics) {
  const Token token = tokens.next();
  if (token.kind == Token::Kind::kError) return tokens.status();
  if (token.kind != Token::Kind::kWord)
    return diagnostics.error(token.loc, "expected a number{}",
                             token.kind == Token::Kind::kEnd ? ", but the text ends" : "");
  return number_of(token, diagnostics);
}

absl::StatusOr<Params> read_params(TokenStream& tokens, Diagnostics& diagnostics) {
  Params params;
  while (tokens.peek().kind == Token::Kind::kString) {
    const Token declaration = tokens.next();
    Param param;
    ASSIGN_OR_RETURN(const Type* const type, read_declaration(declaration, param, diagnostics));
    RETURN_IF_ERROR(read_values(tokens, *type, param, diagnostics));
    RETURN_IF_ERROR(check_arity(*type, param, diagnostics));
    params.all.push_back(std::move(param));
  }
  if (tokens.peek().kind == Token::Kind::kError) return tokens.status();
  return params;
}

}  // namespace penumbra

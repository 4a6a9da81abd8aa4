#include "scenes/token_stream.h"

#include "scenes/read_file.h"

namespace penumbra {
namespace {

constexpr size_t kDeepestInclude = 64;
// Files that include one another twice each double the text at every level. Scenes do such things on
// purpose (a Menger sponge of nested includes reads 0.7 GB); some seconds of it are granted.
constexpr uint64_t kMostRepeatedBytes = uint64_t{2} << 30;
constexpr uint64_t kCostOfOneInclude = 1024;  // finding and entering a file, in bytes lexed

}  // namespace

absl::Status TokenStream::open_main(const std::string& name) {
  PENUMBRA_CHECK(open_.empty() && diagnostics_.files.empty());
  const absl::StatusOr<std::string> path = files_.path_of(name);
  if (!path.ok()) return invalid_input("{}: {}", name, message_of(path.status()));
  absl::StatusOr<std::string> bytes = read_file(*path);
  if (!bytes.ok()) return invalid_input("{}: {}", name, message_of(bytes.status()));
  const Text& text = texts_.emplace(*path, Text{*std::move(bytes), 0}).first->second;
  diagnostics_.files.push_back(name);
  open_.push_back({Lexer(text.bytes, text.file), &text});
  return absl::OkStatus();
}

absl::StatusOr<const TokenStream::Text*> TokenStream::read_text(const std::string& name, FileLoc loc) {
  const absl::StatusOr<std::string> path = files_.path_of(name);
  if (!path.ok())
    return diagnostics_.error(loc, "cannot include '{}': {}", printable(name), message_of(path.status()));
  if (const auto known = texts_.find(*path); known != texts_.end()) return &known->second;
  absl::StatusOr<std::string> bytes = read_file(*path);
  if (!bytes.ok())
    return diagnostics_.error(loc, "cannot include '{}': {}", printable(name), message_of(bytes.status()));
  const auto file = static_cast<uint32_t>(diagnostics_.files.size());
  diagnostics_.files.push_back(name);
  return &texts_.emplace(*path, Text{*std::move(bytes), file}).first->second;
}

absl::StatusOr<const TokenStream::Text*> TokenStream::text_of(const std::string& name, FileLoc loc) {
  const auto known = texts_by_name_.find(name);
  if (known == texts_by_name_.end()) {
    ASSIGN_OR_RETURN(const Text* const text, read_text(name, loc));
    return texts_by_name_[name] = text;
  }
  repeated_bytes_ += known->second->bytes.size() + kCostOfOneInclude;
  if (repeated_bytes_ > kMostRepeatedBytes)
    return diagnostics_.error(loc, "files included again and again add up to more than {} bytes",
                              kMostRepeatedBytes);
  return known->second;
}

absl::Status TokenStream::enter(const std::string& name, FileLoc loc) {
  if (open_.size() >= kDeepestInclude)
    return diagnostics_.error(loc, "files are included more than {} deep", kDeepestInclude);
  ASSIGN_OR_RETURN(const Text* const text, text_of(name, loc));
  for (const Source& source : open_)
    if (source.text == text) return diagnostics_.error(loc, "'{}' includes itself", printable(name));
  open_.push_back({Lexer(text->bytes, text->file), text});
  return absl::OkStatus();
}

Token TokenStream::fail(absl::Status status, FileLoc loc) {
  status_ = std::move(status);
  return {Token::Kind::kError, {}, loc};
}

Token TokenStream::read() {
  if (!status_.ok()) return {Token::Kind::kError, {}, {}};
  for (;;) {
    PENUMBRA_CHECK(!open_.empty());
    const Token token = open_.back().lexer.next();
    switch (token.kind) {
      case Token::Kind::kError:
        return fail(diagnostics_.error(token.loc, "{}", token.text), token.loc);
      case Token::Kind::kEnd:
        if (open_.size() == 1) return token;
        open_.pop_back();
        break;
      case Token::Kind::kWord: {
        if (token.text != "Include") return token;
        const Token name = open_.back().lexer.next();
        if (name.kind != Token::Kind::kString)
          return fail(diagnostics_.error(token.loc, "Include needs a quoted file name"), token.loc);
        if (absl::Status status = enter(unescape(name.text), token.loc); !status.ok())
          return fail(std::move(status), token.loc);
        break;
      }
      default:
        return token;
    }
  }
}

const Token& TokenStream::peek() {
  if (!has_peeked_) peeked_ = read();
  has_peeked_ = true;
  return peeked_;
}

Token TokenStream::next() {
  const Token token = peek();
  has_peeked_ = token.kind == Token::Kind::kEnd || token.kind == Token::Kind::kError;
  return token;
}

}  // namespace penumbra

#include "scenes/parser.h"

#include <filesystem>
#include <set>

#include "scenes/directives.h"
#include "scenes/param_reader.h"
#include "scenes/token_stream.h"

namespace penumbra {
namespace {

using Kind = Token::Kind;

/// Reads one directive after the other and hands it to the builder.
class Parser {
 public:
  explicit Parser(const SceneFiles& files) : tokens_(files, diagnostics_), builder_(diagnostics_) {}

  absl::StatusOr<SceneDescription> run(const std::string& main_name) {
    RETURN_IF_ERROR(tokens_.open_main(main_name));
    for (;;) {
      close_imports();
      const Token token = tokens_.next();
      if (token.kind == Kind::kError) return tokens_.status();
      if (token.kind == Kind::kEnd) return finish(token.loc);
      RETURN_IF_ERROR(directive(token));
    }
  }

 private:
  absl::Status directive(const Token& token);
  absl::StatusOr<Statement> read(const Directive& directive, const Token& token);
  absl::Status read_numbers(const Directive& directive, Statement& statement);
  absl::Status read_strings(const Directive& directive, Statement& statement);
  bool is_in_place(const Directive& directive, FileLoc loc);
  absl::Status import(const Token& token);

  /// Imports whose files are over give the state back that they began with.
  void close_imports() {
    tokens_.peek();
    while (!import_depths_.empty() && tokens_.depth() < import_depths_.back()) {
      builder_.end_import();
      import_depths_.pop_back();
    }
  }

  SceneDescription finish(FileLoc end) {
    SceneDescription description = builder_.finish(end);
    description.files = std::move(diagnostics_.files);
    description.warnings = std::move(diagnostics_.warnings);
    return description;
  }

  Diagnostics diagnostics_;
  TokenStream tokens_;
  SceneBuilder builder_;
  std::vector<size_t> import_depths_;
  std::set<std::string_view> misplaced_;  ///< directives that have been warned about
};

absl::Status Parser::directive(const Token& token) {
  if (token.kind != Kind::kWord)
    return diagnostics_.error(token.loc, "expected a directive, found {}{}{}",
                              token.kind == Kind::kString ? "\"" : "", printable(token.text),
                              token.kind == Kind::kString ? "\"" : "");
  if (token.text == "Import") return import(token);
  const Directive* const directive = find_directive(token.text);
  if (!directive) return diagnostics_.error(token.loc, "unknown directive '{}'", printable(token.text));
  ASSIGN_OR_RETURN(Statement statement, read(*directive, token));
  if (!is_in_place(*directive, token.loc)) return absl::OkStatus();
  return directive->apply(builder_, statement);
}

absl::StatusOr<Statement> Parser::read(const Directive& directive, const Token& token) {
  Statement statement;
  statement.loc = token.loc;
  RETURN_IF_ERROR(read_strings(directive, statement));
  RETURN_IF_ERROR(read_numbers(directive, statement));
  if (directive.params) {
    ASSIGN_OR_RETURN(statement.params, read_params(tokens_, diagnostics_));
  }
  return statement;
}

absl::Status Parser::read_strings(const Directive& directive, Statement& statement) {
  for (int i = 0; i < directive.strings; ++i) {
    const Token token = tokens_.next();
    if (token.kind == Kind::kError) return tokens_.status();
    // ActiveTransform's word is bare; every other name is quoted.
    const Kind wanted = directive.name == "ActiveTransform" ? Kind::kWord : Kind::kString;
    if (token.kind != wanted)
      return diagnostics_.error(token.loc, "{} needs {}{}", directive.name,
                                wanted == Kind::kString ? "a quoted name" : "a word",
                                token.kind == Kind::kEnd ? ", but the text ends" : "");
    statement.strings.push_back(unescape(token.text));
  }
  for (int i = 0; i < directive.optional_strings; ++i) {
    if (tokens_.peek().kind != Kind::kString) break;
    statement.strings.push_back(unescape(tokens_.next().text));
  }
  return absl::OkStatus();
}

absl::Status Parser::read_numbers(const Directive& directive, Statement& statement) {
  if (directive.numbers == 0) return absl::OkStatus();
  const bool bracketed = tokens_.peek().kind == Kind::kOpen;
  if (bracketed) tokens_.next();
  for (int i = 0; i < directive.numbers; ++i) {
    ASSIGN_OR_RETURN(const double number, read_number(tokens_, diagnostics_));
    statement.numbers.push_back(number);
  }
  if (!bracketed) return absl::OkStatus();
  const Token close = tokens_.next();
  if (close.kind == Kind::kError) return tokens_.status();
  if (close.kind != Kind::kClose)
    return diagnostics_.error(close.loc, "{} takes {} numbers; expected ]", directive.name,
                              directive.numbers);
  return absl::OkStatus();
}

bool Parser::is_in_place(const Directive& directive, FileLoc loc) {
  const char* why = nullptr;
  if (builder_.after_world())
    why = "after WorldEnd";
  else if (directive.place == Directive::Place::kInWorld && !builder_.in_world())
    why = "before WorldBegin";
  else if (directive.place == Directive::Place::kBeforeWorld && builder_.in_world())
    why = "after WorldBegin";
  if (why && misplaced_.insert(directive.name).second)
    diagnostics_.warn(loc, "{} {} is left out, as in pbrt (said once of all {})", directive.name, why,
                      directive.name);
  return !why;
}

absl::Status Parser::import(const Token& token) {
  const Token name = tokens_.next();
  if (name.kind == Kind::kError) return tokens_.status();
  if (name.kind != Kind::kString) return diagnostics_.error(token.loc, "Import needs a quoted file name");
  RETURN_IF_ERROR(tokens_.enter(unescape(name.text), token.loc));
  builder_.begin_import();
  import_depths_.push_back(tokens_.depth());
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SceneDescription> parse_scene(const std::string& main_name, const SceneFiles& files) {
  return Parser(files).run(main_name);
}

absl::StatusOr<SceneDescription> parse_scene_file(const std::string& path) {
  const std::filesystem::path whole(path);
  return parse_scene(whole.filename().string(), FolderFiles(whole.parent_path().string()));
}

}  // namespace penumbra

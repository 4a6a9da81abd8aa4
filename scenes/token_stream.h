#pragma once
// The tokens of a scene: its main file with every Include put in its place. Include is textual, as in
// pbrt: the included text may go on with the parameters of a directive that began outside, and the other
// way round.
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/diagnostics.h"
#include "scenes/files.h"
#include "scenes/lexer.h"

namespace penumbra {

class TokenStream {
 public:
  TokenStream(const SceneFiles& files, Diagnostics& diagnostics) : files_(files), diagnostics_(diagnostics) {}

  absl::Status open_main(const std::string& name);

  /// The next token, Includes already followed. After a kError or kEnd: the same again.
  /// Its text is valid as long as this stream.
  const Token& peek();
  Token next();

  /// Goes on with the text of `name` (v4's Import); is_open(mark) tells when it is over.
  absl::Status enter(const std::string& name, FileLoc loc);
  /// Files that are open now. Ends of files are noticed by peek().
  size_t depth() const { return open_.size(); }

  /// Why the last token was a kError.
  const absl::Status& status() const { return status_; }

 private:
  struct Text {
    std::string bytes;
    uint32_t file = 0;
  };
  struct Source {
    Lexer lexer;
    const Text* text;
  };

  Token read();
  Token fail(absl::Status status, FileLoc loc);
  absl::StatusOr<const Text*> text_of(const std::string& name, FileLoc loc);
  absl::StatusOr<const Text*> read_text(const std::string& name, FileLoc loc);

  const SceneFiles& files_;
  Diagnostics& diagnostics_;
  /// Keyed by path; stays until the end, so that tokens stay valid and a file that is included often is
  /// read once.
  std::unordered_map<std::string, Text> texts_;
  std::unordered_map<std::string, const Text*> texts_by_name_;  ///< spares asking the system again
  std::vector<Source> open_;
  Token peeked_;
  bool has_peeked_ = false;
  uint64_t repeated_bytes_ = 0;
  absl::Status status_;
};

}  // namespace penumbra

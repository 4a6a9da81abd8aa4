#pragma once
// What the parser has to say about a text: one error that ends it, or warnings that travel with the result.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/status.h"
#include "scenes/description.h"

namespace penumbra {

/// `file:line:column` of a location among these files.
std::string place_in(const std::vector<std::string>& files, FileLoc loc);

/// Text from a file as a message may show it: always UTF-8, bytes that do not print or are not UTF-8 as
/// `\xNN`, cut after 160 bytes.
std::string printable(std::string_view text);

struct Diagnostics {
  std::vector<std::string> files;  ///< FileLoc::file indexes these
  std::vector<std::string> warnings;

  /// InvalidArgument `file:line:column: message`.
  template <class... Args>
  absl::Status error(FileLoc loc, fmt::format_string<Args...> text, Args&&... args) const {
    return invalid_input("{}: {}", place_in(files, loc), fmt::format(text, std::forward<Args>(args)...));
  }

  template <class... Args>
  void warn(FileLoc loc, fmt::format_string<Args...> text, Args&&... args) {
    warnings.push_back(
        fmt::format("{}: {}", place_in(files, loc), fmt::format(text, std::forward<Args>(args)...)));
  }
};

}  // namespace penumbra

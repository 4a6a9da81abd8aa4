#include "scenes/diagnostics.h"

#include "proto/utf8.h"

namespace penumbra {

std::string place_in(const std::vector<std::string>& files, FileLoc loc) {
  PENUMBRA_CHECK(loc.file < files.size());
  return fmt::format("{}:{}:{}", printable(files[loc.file]), loc.line, loc.column);
}

std::string printable(std::string_view text) {
  constexpr size_t kMostShown = 160;
  std::string out;
  while (!text.empty()) {
    if (out.size() >= kMostShown) return out + "…";
    const auto byte = static_cast<unsigned char>(text[0]);
    const size_t length = byte < 0x20 || byte == 0x7f ? 0 : utf8_sequence(text);
    if (length == 0)
      out += fmt::format("\\x{:02x}", byte);
    else
      out += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

}  // namespace penumbra

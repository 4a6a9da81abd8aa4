#include "scenes/diagnostics.h"

namespace penumbra {

std::string place_in(const std::vector<std::string>& files, FileLoc loc) {
  PENUMBRA_CHECK(loc.file < files.size());
  return fmt::format("{}:{}:{}", files[loc.file], loc.line, loc.column);
}

std::string printable(std::string_view text) {
  constexpr size_t kMostShown = 40;
  std::string out;
  for (const char c : text.substr(0, kMostShown)) {
    const auto byte = static_cast<unsigned char>(c);
    // Bytes from 0x80 on are left alone: they are UTF-8 in every file that a person can read.
    if (byte < 0x20 || byte == 0x7f)
      out += fmt::format("\\x{:02x}", byte);
    else
      out += c;
  }
  if (text.size() > kMostShown) out += "…";
  return out;
}

}  // namespace penumbra

#include "proto/wire_text.h"

#include <cstdint>

#include "proto/status.h"

namespace penumbra {
namespace {

constexpr std::string_view kCut = "…";

/// Bytes of the character of UTF-8 that `text` begins with; 0 if it begins with none (RFC 3629: no overlong
/// forms, no surrogates, nothing beyond U+10FFFF).
size_t character_size(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  const uint8_t first = byte(0);
  if (first < 0x80) return 1;
  const size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < size) return 0;
  for (size_t i = 1; i < size; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const bool overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool surrogate = first == 0xED && byte(1) >= 0xA0, beyond = first == 0xF4 && byte(1) >= 0x90;
  return overlong || surrogate || beyond ? 0 : size;
}

}  // namespace

std::string wire_text(std::string_view text, size_t most) {
  PENUMBRA_CHECK(most >= kCut.size());
  std::string out;
  size_t cut_at = 0;  // where there is still room for the mark
  while (!text.empty()) {
    const size_t size = character_size(text);
    out += size == 0 ? std::string_view("?") : text.substr(0, size);
    text.remove_prefix(std::max<size_t>(size, 1));
    if (out.size() + kCut.size() <= most) cut_at = out.size();
    if (out.size() > most) return out.substr(0, cut_at).append(kCut);
  }
  return out;
}

std::vector<std::string> wire_texts(const std::vector<std::string>& texts, size_t most, size_t most_bytes) {
  std::vector<std::string> out;
  size_t bytes = 0;
  for (const std::string& text : texts) {
    std::string sent = wire_text(text, most);
    bytes += sent.size();
    if (bytes > most_bytes) {
      out.push_back(fmt::format("and {} more", texts.size() - out.size()));
      break;
    }
    out.push_back(std::move(sent));
  }
  return out;
}

}  // namespace penumbra

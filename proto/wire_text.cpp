#include "proto/wire_text.h"

#include <algorithm>

#include "proto/status.h"
#include "proto/utf8.h"

namespace penumbra {
namespace {

constexpr std::string_view kCut = "…";

}  // namespace

std::string wire_text(std::string_view text, size_t most) {
  PENUMBRA_CHECK(most >= kCut.size());
  std::string out;
  size_t cut_at = 0;  // where there is still room for the mark
  while (!text.empty()) {
    const size_t size = utf8_sequence(text);
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

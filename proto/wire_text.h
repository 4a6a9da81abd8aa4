#pragma once
// Text as a message can carry it. Protobuf refuses a whole message for one byte that is not UTF-8.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra {

/// `text` with `?` in place of bytes that are not UTF-8, and of more than `most` bytes the beginning and "…".
std::string wire_text(std::string_view text, size_t most);

/// Each of them as wire_text(); of those that together have more than `most_bytes` the first, and a last line
/// that says how many are left out.
std::vector<std::string> wire_texts(const std::vector<std::string>& texts, size_t most, size_t most_bytes);

}  // namespace penumbra

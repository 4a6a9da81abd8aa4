#pragma once
#include <cstddef>
#include <string_view>

namespace penumbra {

/// Bytes of the well-formed UTF-8 sequence that `text` begins with (RFC 3629: no overlong forms, no
/// surrogates, nothing above U+10FFFF); 0 if it begins with none.
size_t utf8_sequence(std::string_view text);

bool is_utf8(std::string_view text);

}  // namespace penumbra

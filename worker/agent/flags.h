#pragma once
// Amounts as the worker's flags write them. InvalidArgument names the flag.
#include <cstdint>
#include <string_view>

#include "absl/status/statusor.h"

namespace penumbra {

/// `500ms`, `30s`, `2m`, `1h` -> seconds, > 0.
absl::StatusOr<double> parse_duration_flag(std::string_view flag, std::string_view text);
/// `512M`, `8G`, `1T` (powers of 1024) -> bytes, > 0.
absl::StatusOr<uint64_t> parse_bytes_flag(std::string_view flag, std::string_view text);

}  // namespace penumbra

#pragma once
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace penumbra {

/// What the system call that just failed says (errno) of `path`: NotFound; ResourceExhausted for a full disk,
/// a quota or a file that grew too large; Internal otherwise. «what path: reason»
absl::Status system_error(std::string_view what, const std::string& path);

}  // namespace penumbra

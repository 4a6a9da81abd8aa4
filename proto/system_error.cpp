#include "proto/system_error.h"

#include <cerrno>
#include <cstring>

#include "proto/status.h"

namespace penumbra {

absl::Status system_error(std::string_view what, const std::string& path) {
  const int error = errno;
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  const auto code = error == ENOENT ? absl::StatusCode::kNotFound
                    : full          ? absl::StatusCode::kResourceExhausted
                                    : absl::StatusCode::kInternal;
  return make_status(code, "{} {}: {}", what, path, std::strerror(error));
}

}  // namespace penumbra

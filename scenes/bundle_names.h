#pragma once
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace penumbra {

/// The name inside a bundle of a file that a scene's text refers to so: `.` and `a/..` are folded away,
/// `../x` becomes `up1/x`, `/x` becomes `root/x`, backslashes become slashes. Where a scene's own folder is
/// called up1, root or in, its files go below `in/`, so that different files never share a name.
std::string bundle_name(std::string_view reference);

/// InvalidArgument unless the name is UTF-8, relative, of plain components, without `.`, `..`, backslash or
/// NUL.
absl::Status check_bundle_name(std::string_view name);

}  // namespace penumbra

#pragma once
#include <string>

#include "absl/status/status.h"

namespace penumbra {

/// (Re)writes folder/report.html from folder/run.json and the images that it names: one page without any
/// other file. An image or a reference that is missing is said on the page.
absl::Status write_report(const std::string& folder);

}  // namespace penumbra

#pragma once
// What the report's page shows, as one JSON value.
#include <string>

#include "absl/status/statusor.h"
#include "client/job_json.h"

namespace penumbra {

/// {"run","images":[…],"reference","flipbook","notes":[…]}: run.json's content, its images and its reference,
/// the latter over the images' window, and of a job with --transient its flip-book (client/flipbook.h). What
/// cannot be read is null and a note.
absl::StatusOr<Json> report_data(const std::string& folder);

}  // namespace penumbra

#pragma once
// A finished (or interrupted) job -> the run's folder: an EXR per mix, run.json, report.html.
#include <optional>
#include <stop_token>
#include <string>

#include "absl/status/statusor.h"
#include "client/run_json.h"
#include "client/server.h"

namespace penumbra {

/// Fetches what there is of a job and writes it into `folder` (made if need be), image by image, so that
/// a late fault loses nothing. With the job's reference come error figures and the timeline. EXRs of an
/// earlier run in that folder are removed, and only those (client/output_folder.h). Answers with run.json's
/// content.
absl::StatusOr<Json> write_outcome(Server& server, const JobId& job, const std::string& folder, bool partial,
                                   std::stop_token stop);

/// Reads a reference and checks that it can serve a job; NotFound, InvalidArgument name --reference.
absl::StatusOr<FilmImage> read_reference(const JobSpec& spec);

/// The table that people read, and where the files are.
std::string outcome_text(const Json& run, const std::string& folder);

}  // namespace penumbra

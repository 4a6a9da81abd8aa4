#pragma once
// The folder that a run is written into: looked at before anything is rendered, so that hours of rendering do
// not end at a wrong --out.
#include <filesystem>
#include <string>

#include "absl/status/status.h"
#include "proto/job.h"

namespace penumbra {

/// Makes the folder and writes a file there, which it removes again. InvalidArgument names --out.
absl::Status prepare_folder(const std::filesystem::path& folder);

/// Where the image of a mix goes.
std::string image_name(const std::string& label);

/// InvalidArgument, naming --reference, if one of the job's images would be written over its reference.
absl::Status check_reference_stays(const JobSpec& spec, const std::filesystem::path& folder);

/// Images that an earlier run left in the folder, by its own run.json; nothing else is touched, nor
/// `reference`.
void remove_old_images(const std::filesystem::path& folder, const std::string& reference);

}  // namespace penumbra

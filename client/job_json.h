#pragma once
// JobSpec <-> JSON: the part of run.json from which `replay` renders again.
#include <nlohmann/json.hpp>

#include "absl/status/statusor.h"
#include "proto/job.h"

namespace penumbra {

using Json = nlohmann::ordered_json;

Json to_json(const PixelRect& rect);
Json to_json(const Budget& budget);
/// {"t0","t1","bins"} or null.
Json to_json(const std::optional<Transient>& transient);
Json to_json(const JobSpec& spec);
/// InvalidArgument names the key at fault. job_from_json(to_json(x)) == x.
absl::StatusOr<JobSpec> job_from_json(const Json& json);

}  // namespace penumbra

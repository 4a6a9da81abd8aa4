#pragma once
// A job's header and a result's costs as bytes in the job store.
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "server/changes.h"

namespace penumbra {

std::string serialize_header(const JobHeader& header);
/// DataLoss for bytes that are not a header.
absl::StatusOr<JobHeader> parse_header(std::string_view bytes);

std::string serialize_costs(const std::vector<MixCost>& costs);
absl::StatusOr<std::vector<MixCost>> parse_costs(std::string_view bytes);

std::string serialize_worker(const WorkerInfo& worker);
absl::StatusOr<WorkerInfo> parse_worker(std::string_view bytes);

}  // namespace penumbra

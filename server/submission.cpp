#include "server/submission.h"

#include "proto/convert.h"
#include "proto/status.h"
#include "proto/tiles.h"
#include "scenes/bundle.h"
#include "server/planner.h"

namespace penumbra {
namespace {

// What a job may ask of the coordinator's memory: a plan has a dozen ranges and more (server/planner.cpp),
// and each of them is a task of some 250 bytes for every tile.
constexpr uint64_t kMostTilesOfJob = uint64_t{1} << 17;

/// The bundle's index must be sound and all its blobs here, or a worker would find out much later.
absl::Status check_bundle(const BlobFolder& blobs, const JobSpec& spec) {
  // Looked at before it is read: a blob may be larger than memory.
  if (blobs.size(spec.bundle).value_or(0) > kMostIndexBytes)
    return invalid_input("bundle: an index of more than {} bytes", kMostIndexBytes);
  const absl::StatusOr<std::string> json = blobs.read(spec.bundle);
  if (!json.ok())
    return make_status(absl::StatusCode::kFailedPrecondition, "the bundle's index {} is missing",
                       spec.bundle);
  ASSIGN_OR_RETURN(const BundleIndex index, parse_bundle_index(*json));
  for (const BundleEntry& entry : index.entries) {
    if (!is_digest(entry.digest)) return invalid_input("bundle: {}: not a digest", entry.name);
    const auto size = blobs.size(entry.digest);
    if (!size)
      return make_status(absl::StatusCode::kFailedPrecondition, "the bundle's blob {} ({}) is missing",
                         entry.digest, entry.name);
    if (*size != entry.size)
      return invalid_input("bundle: {}: the index says {} bytes, the blob has {}", entry.name, entry.size,
                           *size);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<JobSpec> checked_spec(const BlobFolder& blobs, const v1::SubmitRequest& request) {
  if (request.request_id().empty() || request.request_id().size() > 128)
    return invalid_input("request_id: must have 1 to 128 characters");
  ASSIGN_OR_RETURN(JobSpec spec, from_proto(request.spec()));
  // Counted, not listed: 65536² tiles of a pixel would be 64 GiB.
  if (tile_count(spec) > kMostTilesOfJob)
    return invalid_input("tile: {} pixels make more than {} tiles of this picture", spec.tile,
                         kMostTilesOfJob);
  if (!spec.plan.empty())
    RETURN_IF_ERROR(check_stages(spec, {spec.plan, spec.auto_plans, spec.earlier_plans}));
  RETURN_IF_ERROR(check_bundle(blobs, spec));
  return spec;
}

}  // namespace penumbra

#pragma once
// What must hold of a job before it is one.
#include "absl/status/statusor.h"
#include "proto/blob_folder.h"
#include "proto/job.h"
#include "proto/render.pb.h"

namespace penumbra {

/// The job that a request asks for. InvalidArgument: the request id or the spec is out of range, or the
/// bundle's index is malformed or names what is not in it. FailedPrecondition: blobs of the bundle are not
/// here.
absl::StatusOr<JobSpec> checked_spec(const BlobFolder& blobs, const v1::SubmitRequest& request);

}  // namespace penumbra

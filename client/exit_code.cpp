#include "client/exit_code.h"

namespace penumbra {

ExitCode exit_code(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return kExitDone;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kOutOfRange:
      return kExitBadInput;
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kDeadlineExceeded:
      return kExitUnreachable;
    case absl::StatusCode::kCancelled:
      return kExitInterrupted;
    default:
      return kExitJobFailed;
  }
}

ExitCode exit_code(const JobStatus& status) {
  if (status.state == JobState::kDone) return kExitDone;
  return status.state == JobState::kFailed && status.failure == FailureKind::kBadInput ? kExitBadInput
                                                                                       : kExitJobFailed;
}

}  // namespace penumbra

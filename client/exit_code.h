#pragma once
#include "absl/status/status.h"
#include "proto/run.h"

namespace penumbra {

/// What the programs promise to scripts.
enum ExitCode : int {
  kExitDone = 0,
  kExitJobFailed = 1,
  kExitBadInput = 2,  ///< bad usage or bad input
  kExitWorse = 3,         ///< gate
  kExitInconclusive = 4,  ///< gate
  kExitUnreachable = 5,
  kExitInterrupted = 130,
};

/// InvalidArgument, NotFound, OutOfRange: bad input. Unavailable, DeadlineExceeded: the server cannot be
/// reached. Cancelled: interrupted. Anything else: failed.
ExitCode exit_code(const absl::Status& status);
/// Of a job in a final state; a cancelled job counts as failed.
ExitCode exit_code(const JobStatus& status);

}  // namespace penumbra

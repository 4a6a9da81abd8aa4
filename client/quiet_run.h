#pragma once
// A job whose outcome is figures, not a folder: what gate --against, calibrate and converge are made of.
#include <stop_token>
#include <string>

#include "client/progress.h"
#include "client/server.h"

namespace penumbra {

/// Why a job that is not done has ended.
absl::Status failure_of(const JobStatus& status);

/// Submits (the bundle is uploaded already), follows and fetches. Aborted or InvalidArgument if the job
/// fails, Cancelled if the token stops: then the job is cancelled too. `each` is asked at every status.
absl::StatusOr<FetchedRun> run_quietly(Server& server, const JobSpec& spec, std::stop_token stop,
                                       const Server::EachStatus& each);

}  // namespace penumbra

#include "client/quiet_run.h"

#include "client/exit_code.h"
#include "proto/status.h"

namespace penumbra {

absl::Status failure_of(const JobStatus& status) {
  const auto code =
      exit_code(status) == kExitBadInput ? absl::StatusCode::kInvalidArgument : absl::StatusCode::kAborted;
  return make_status(
      code, "{}",
      status.message.empty() ? std::string("the job ") + std::string(name_of(status.state)) : status.message);
}

absl::StatusOr<FetchedRun> run_quietly(Server& server, const JobSpec& spec, std::stop_token stop,
                                       const Server::EachStatus& each) {
  ASSIGN_OR_RETURN(const JobId job, server.submit(spec, stop));
  const absl::StatusOr<JobStatus> last = server.watch(job, stop, each);
  if (!last.ok()) {
    if (stop.stop_requested()) (void)server.cancel(job);
    return last.status();
  }
  if (last->state != JobState::kDone) return failure_of(*last);
  return server.fetch(job, stop, {});
}

}  // namespace penumbra

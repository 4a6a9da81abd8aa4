#include <cstdio>

#include "client/job_command.h"
#include "proto/status.h"

namespace penumbra {

void add_cancel(CLI::App& app, Chosen& chosen) {
  add_job_command(app, chosen, "cancel", "End a job; what was rendered can still be fetched",
                  [](Server& server, const JobId& job, std::stop_token) {
                    const absl::StatusOr<JobStatus> status = server.cancel(job);
                    if (status.ok()) fmt::print("{}\n", name_of(status->state));
                    return tell(status.status());
                  });
}

}  // namespace penumbra

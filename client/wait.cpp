#include <cstdio>

#include "client/commands.h"
#include "client/exit_code.h"
#include "client/job_command.h"
#include "client/progress.h"
#include "proto/status.h"

namespace penumbra {
namespace {

/// Follows a job to its end; the job's exit code. Ctrl-C ends the waiting, not the job.
int follow(Server& server, const JobId& job, Progress::Style style, std::stop_token stop) {
  Progress progress(style);
  const absl::StatusOr<JobStatus> last = server.watch(job, stop, [&](const JobStatus& status) {
    progress.show(status);
    return absl::OkStatus();
  });
  progress.clear();
  if (!last.ok()) return tell(last.status());
  if (last->state != JobState::kDone) {
    const bool says_more = !last->message.empty() && last->message != name_of(last->state);
    fmt::print(stderr, "penumbra: job {} {}{}{}\n", job, name_of(last->state), says_more ? ": " : "",
               says_more ? last->message : "");
  }
  return exit_code(*last);
}

}  // namespace

void add_wait(CLI::App& app, Chosen& chosen) {
  add_job_command(app, chosen, "wait", "Wait for a job; its exit code",
                  [](Server& server, const JobId& job, auto stop) {
                    return follow(server, job, Progress::Style::kSilent, stop);
                  });
}

void add_watch(CLI::App& app, Chosen& chosen) {
  add_job_command(app, chosen, "watch", "Follow a job's progress to its end",
                  [](Server& server, const JobId& job, auto stop) {
                    return follow(server, job, Progress::style_for(false), stop);
                  });
}

}  // namespace penumbra

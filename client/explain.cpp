#include <cstdio>

#include "client/job_command.h"
#include "proto/status.h"

namespace penumbra {

void add_explain(CLI::App& app, Chosen& chosen) {
  add_job_command(app, chosen, "explain", "Why a job is (not) running",
                  [](Server& server, const JobId& job, auto stop) {
                    const auto reasons = server.explain(job, stop);
                    if (!reasons.ok()) return tell(reasons.status());
                    for (const std::string& reason : *reasons) fmt::print("{}\n", reason);
                    return 0;
                  });
}

}  // namespace penumbra

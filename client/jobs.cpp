#include <cstdio>
#include <memory>

#include "client/commands.h"
#include "client/server.h"
#include "proto/status.h"

namespace penumbra {
namespace {

absl::StatusOr<std::vector<JobStatus>> list(const ServerOptions& o, std::stop_token stop) {
  ASSIGN_OR_RETURN(Server server, Server::open(o.address, o.credentials));
  return server.jobs(stop);
}

std::string labels_text(const JobTerms& terms) {
  std::string text;
  for (const std::string& label : terms.labels) text += "  " + label;
  return text;
}

}  // namespace

void add_jobs(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand("jobs", "List a server's jobs, newest first");
  auto options = std::make_shared<ServerOptions>();
  add_server_options(*command, *options, true);
  command->callback([options, &chosen] {
    chosen.run = [options](std::stop_token stop) {
      const absl::StatusOr<std::vector<JobStatus>> jobs = list(*options, stop);
      if (!jobs.ok()) return tell(jobs.status());
      for (const JobStatus& job : *jobs)
        fmt::print("{:16}  {:9}  {:3.0f} %  {:8}  {:4}  {}{}\n", job.job, name_of(job.state),
                   100 * job.fraction, job.terms.user, job.terms.priority, job.scene, labels_text(job.terms));
      return 0;
    };
  });
}

}  // namespace penumbra

#include <cstdio>
#include <memory>

#include "client/commands.h"
#include "client/server.h"
#include "client/submission.h"
#include "client/terms.h"
#include "proto/status.h"

namespace penumbra {
namespace {

struct SubmitOptions {
  JobOptions job;
  ServerOptions server;
  TermsOptions terms;
};

absl::StatusOr<JobId> submit(const SubmitOptions& o, std::stop_token stop) {
  ASSIGN_OR_RETURN(const JobTerms terms, make_terms(o.terms));
  ASSIGN_OR_RETURN(Server server, Server::open(o.server.address, o.server.credentials));
  ASSIGN_OR_RETURN(const Submission submission, prepare(o.job));
  for (const std::string& warning : submission.warnings) fmt::print(stderr, "warning: {}\n", warning);
  RETURN_IF_ERROR(server.upload(submission.bundle, stop));
  return server.submit(submission.spec, stop, terms);
}

}  // namespace

void add_submit(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand("submit", "Hand a scene to a server and print the job's id");
  auto options = std::make_shared<SubmitOptions>();
  add_job_options(*command, options->job);
  add_server_options(*command, options->server, true);
  add_terms_options(*command, options->terms);
  command->callback([options, &chosen] {
    chosen.run = [options](std::stop_token stop) {
      const absl::StatusOr<JobId> job = submit(*options, stop);
      if (job.ok()) fmt::print("{}\n", *job);
      return tell(job.status());
    };
  });
}

}  // namespace penumbra

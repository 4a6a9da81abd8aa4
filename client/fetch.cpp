#include <cstdio>
#include <memory>

#include "client/job_command.h"
#include "client/outcome.h"
#include "proto/status.h"

namespace penumbra {
namespace {

absl::StatusOr<Json> fetch(Server& server, const JobId& job, const std::string& folder,
                           std::stop_token stop) {
  ASSIGN_OR_RETURN(const JobStatus status, server.status(job, stop));
  return write_outcome(server, job, folder, status.state != JobState::kDone, stop);
}

}  // namespace

void add_fetch(CLI::App& app, Chosen& chosen) {
  auto output = std::make_shared<OutputOptions>();
  CLI::App* command = add_job_command(app, chosen, "fetch", "Write a job's images, run.json and report.html",
                                      [output](Server& server, const JobId& job, std::stop_token stop) {
                                        const absl::StatusOr<Json> run =
                                            fetch(server, job, output->out, stop);
                                        if (!run.ok()) return tell(run.status());
                                        if (output->json)
                                          fmt::print("{}", json_text(*run));
                                        else if (!output->quiet)
                                          fmt::print("{}", outcome_text(*run, output->out));
                                        return 0;
                                      });
  add_output_options(*command, *output);
  command->get_option("--out")->required()->description("Folder for the images, run.json, report.html");
}

}  // namespace penumbra

#include <cstdio>
#include <memory>

#include "client/commands.h"
#include "client/exit_code.h"
#include "client/outcome.h"
#include "client/run_job.h"
#include "proto/status.h"

namespace penumbra {
namespace {

struct RenderOptions {
  JobOptions job;
  ServerOptions server;
  ClusterOptions cluster;
  OutputOptions output;
  std::string display;
};

absl::StatusOr<FinishedRun> render(const RenderOptions& o, const std::string& folder, std::stop_token stop) {
  ASSIGN_OR_RETURN(const Submission submission, prepare(o.job));
  ASSIGN_OR_RETURN(const std::unique_ptr<Backend> backend, open_backend(o.server, o.cluster));
  return run_job(*backend, submission, folder, o.output.quiet, stop, o.display);
}

}  // namespace

void add_render(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand("render", "Render a scene and compare mixes at equal cost");
  auto options = std::make_shared<RenderOptions>();
  add_job_options(*command, options->job);
  add_output_options(*command, options->output);
  add_cluster_options(*command, options->cluster);
  add_server_options(*command, options->server, false);
  command->add_option("--display", options->display, "A tev that shows the pictures while they grow")
      ->type_name("HOST:PORT");
  command->callback([options, &chosen] {
    chosen.run = [options](std::stop_token stop) {
      const OutputOptions& output = options->output;
      const std::string folder = output.out.empty() ? default_folder(options->job.scene) : output.out;
      const absl::StatusOr<FinishedRun> finished = render(*options, folder, stop);
      if (!finished.ok()) return tell(finished.status());
      if (output.json)
        fmt::print("{}", json_text(finished->run));
      else if (!output.quiet)
        fmt::print("{}", outcome_text(finished->run, folder));
      return finished->interrupted ? static_cast<int>(kExitInterrupted) : static_cast<int>(kExitDone);
    };
  });
}

}  // namespace penumbra

#include "client/job_command.h"

#include <memory>

#include "proto/status.h"

namespace penumbra {

CLI::App* add_job_command(CLI::App& app, Chosen& chosen, const std::string& name,
                          const std::string& description, JobAction action) {
  struct Options {
    std::string job;
    ServerOptions server;
  };
  CLI::App* command = app.add_subcommand(name, description);
  auto options = std::make_shared<Options>();
  command->add_option("job", options->job, "The job's id")->required()->type_name("JOB");
  add_server_options(*command, options->server, true);
  command->callback([options, action = std::move(action), &chosen] {
    chosen.run = [options, action](std::stop_token stop) {
      absl::StatusOr<Server> server = Server::open(options->server.address, options->server.credentials);
      return server.ok() ? action(*server, options->job, stop) : tell(server.status());
    };
  });
  return command;
}

}  // namespace penumbra

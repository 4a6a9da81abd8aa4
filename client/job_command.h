#pragma once
// A subcommand about one job of a server: JOB, --server, and what to do.
#include <functional>
#include <string>

#include "client/commands.h"
#include "client/server.h"

namespace penumbra {

using JobAction = std::function<int(Server& server, const JobId& job, std::stop_token stop)>;
/// The subcommand, for further options.
CLI::App* add_job_command(CLI::App& app, Chosen& chosen, const std::string& name,
                          const std::string& description, JobAction action);

}  // namespace penumbra

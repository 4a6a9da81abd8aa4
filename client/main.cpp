// penumbra: the command line.
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "client/commands.h"
#include "client/exit_code.h"
#include "client/interrupt.h"

int main(int argc, char** argv) {
  using namespace penumbra;
  Interrupt interrupt;

  CLI::App app("Penumbra renders direct illumination with points and lines, at equal time", "penumbra");
  app.set_version_flag("--version", "penumbra " PENUMBRA_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  std::string log_level = "warning";
  app.add_option("--log-level", log_level, "trace, debug, info, warning, error or off")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error", "off"}));

  Chosen chosen;
  for (const auto add :
       {add_render, add_submit, add_wait, add_watch, add_explain, add_log, add_health, add_cancel, add_jobs,
        add_fetch, add_inspect, add_compare, add_replay, add_gate, add_calibrate, add_converge, add_report})
    add(app, chosen);
  try {
    // CLI11 would only say that a command is missing.
    const auto named = [&](CLI::App* command) { return command->check_name(argv[1]); };
    if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(named).empty())
      throw CLI::ParseError(std::string("there is no command '") + argv[1] + "'",
                            CLI::ExitCodes::ExtrasError);
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& fault) {
    app.exit(fault, std::cout, std::cerr);
    return kExitBadInput;
  }
  spdlog::set_default_logger(spdlog::stderr_logger_mt("penumbra"));
  spdlog::set_level(spdlog::level::from_str(log_level));
  return chosen.run(interrupt.token());
}

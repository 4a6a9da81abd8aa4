#pragma once
// The subcommands: one file each. add_X describes its options and says what to do when it is chosen; a new
// subcommand is its own file, its line here and in main.cpp.
#include <CLI/App.hpp>
#include <functional>
#include <stop_token>

#include "absl/status/status.h"

namespace penumbra {

/// What the chosen subcommand does; the program's exit code.
struct Chosen {
  std::function<int(std::stop_token)> run;
};

void add_render(CLI::App& app, Chosen& chosen);
void add_submit(CLI::App& app, Chosen& chosen);
void add_wait(CLI::App& app, Chosen& chosen);
void add_watch(CLI::App& app, Chosen& chosen);
void add_explain(CLI::App& app, Chosen& chosen);
void add_log(CLI::App& app, Chosen& chosen);
void add_health(CLI::App& app, Chosen& chosen);
void add_cancel(CLI::App& app, Chosen& chosen);
void add_jobs(CLI::App& app, Chosen& chosen);
void add_fetch(CLI::App& app, Chosen& chosen);
void add_inspect(CLI::App& app, Chosen& chosen);
void add_compare(CLI::App& app, Chosen& chosen);
void add_replay(CLI::App& app, Chosen& chosen);
void add_gate(CLI::App& app, Chosen& chosen);
void add_converge(CLI::App& app, Chosen& chosen);
void add_calibrate(CLI::App& app, Chosen& chosen);
void add_report(CLI::App& app, Chosen& chosen);

/// Says an error on standard error; its exit code. OK: 0, and nothing is said.
int tell(const absl::Status& status);

}  // namespace penumbra

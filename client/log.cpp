#include <cstdio>
#include <ctime>
#include <memory>
#include <optional>

#include "client/job_command.h"
#include "proto/status.h"

namespace penumbra {
namespace {

std::string line_text(const LogLine& line) {
  const auto when = static_cast<std::time_t>(line.unix_seconds);
  char clock[32] = {};
  std::tm local{};
  std::strftime(clock, sizeof clock, "%F %T", localtime_r(&when, &local));
  std::string text = clock;
  if (line.task) text += fmt::format("  task {}", *line.task);
  if (!line.worker.empty()) text += fmt::format("  {}", line.worker);
  return text + "  " + line.text;
}

/// `log` says what became of tasks; `logs` also what workers logged of them.
void add(CLI::App& app, Chosen& chosen, const std::string& name, const std::string& description,
         bool worker_lines) {
  auto tile = std::make_shared<std::optional<uint64_t>>();
  CLI::App* command =
      add_job_command(app, chosen, name, description, [=](Server& server, const JobId& job, auto stop) {
        const auto lines = server.log(job, *tile, worker_lines, stop);
        if (!lines.ok()) return tell(lines.status());
        for (const LogLine& line : *lines) fmt::print("{}\n", line_text(line));
        return 0;
      });
  command->add_option("--tile", *tile, "Only of this tile of the picture, counted row by row from 0");
}

}  // namespace

void add_log(CLI::App& app, Chosen& chosen) {
  add(app, chosen, "log", "What became of a job's tasks, and on which worker", false);
  add(app, chosen, "logs", "The same, with what workers logged while they rendered", true);
}

}  // namespace penumbra

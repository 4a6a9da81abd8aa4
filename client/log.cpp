#include <cstdio>
#include <ctime>

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

}  // namespace

void add_log(CLI::App& app, Chosen& chosen) {
  add_job_command(app, chosen, "log", "What became of a job's tasks, and on which worker",
                  [](Server& server, const JobId& job, auto stop) {
                    const auto lines = server.log(job, stop);
                    if (!lines.ok()) return tell(lines.status());
                    for (const LogLine& line : *lines) fmt::print("{}\n", line_text(line));
                    return 0;
                  });
}

}  // namespace penumbra

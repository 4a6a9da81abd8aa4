#include <cstdio>
#include <filesystem>
#include <memory>

#include "client/commands.h"
#include "client/report.h"
#include "proto/status.h"

namespace penumbra {

void add_report(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand("report", "(Re)write a run's report.html");
  auto folder = std::make_shared<std::string>();
  command->add_option("folder", *folder, "Folder with a run.json")->required()->type_name("DIR");
  command->callback([folder, &chosen] {
    chosen.run = [folder](std::stop_token) {
      const absl::Status status = write_report(*folder);
      if (status.ok())
        fmt::print("{}\n", (std::filesystem::absolute(*folder) / "report.html").lexically_normal().string());
      return tell(status);
    };
  });
}

}  // namespace penumbra

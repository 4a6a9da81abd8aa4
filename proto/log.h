#pragma once
// What server and worker say while they run: one line an event on standard error, as text for people or as
// one JSON object for machines. Never a secret: tokens, keys and request headers have no way in here.
#include <spdlog/common.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/run.h"

namespace penumbra {

enum class LogFormat { kText, kJson };

/// What an event is about; empty where that does not apply.
struct About {
  JobId job;
  std::optional<uint64_t> task;
  std::optional<uint64_t> tile;  ///< of the picture, row by row
  std::string worker;            ///< host/name
};

/// Makes the default logger: standard error from `level` on (a name of spdlog's), and `others`, which have
/// levels of their own. JSON lines have the keys time (UTC), level, program, message and those of About.
void start_log(const std::string& program, const std::string& level, LogFormat format,
               const std::vector<spdlog::sink_ptr>& others = {});

/// Says something about a job, a task, a worker.
void log_about(spdlog::level::level_enum level, const About& about, std::string_view text);

}  // namespace penumbra

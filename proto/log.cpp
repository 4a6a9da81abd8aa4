#include "proto/log.h"

#include <fmt/chrono.h>
#include <spdlog/formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace penumbra {
namespace {

/// Of the event that this thread is logging: spdlog's messages have no room for it. Sinks are synchronous.
thread_local const About* current = nullptr;

std::string prefix(const About& about) {
  std::string text;
  if (!about.job.empty()) text += "job=" + about.job + " ";
  if (about.task) text += fmt::format("task={} ", *about.task);
  if (about.tile) text += fmt::format("tile={} ", *about.tile);
  if (!about.worker.empty()) text += "worker=" + about.worker + " ";
  return text;
}

std::string_view view(spdlog::string_view_t text) {
  return {text.data(), text.size()};
}

/// spdlog's own pattern, with what the event is about before its text.
class TextFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
    using std::chrono::duration_cast;
    const auto since = message.time.time_since_epoch();
    const auto ms = duration_cast<std::chrono::milliseconds>(since).count() % 1000;
    fmt::format_to(std::back_inserter(out), "[{:%F %T}.{:03}] [{}] [{}] {}{}\n",
                   fmt::localtime(spdlog::log_clock::to_time_t(message.time)), ms, view(message.logger_name),
                   view(spdlog::level::to_string_view(message.level)),
                   current == nullptr ? std::string() : prefix(*current), view(message.payload));
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<TextFormatter>(); }
};

class JsonFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
    using std::chrono::duration_cast;
    const auto since = message.time.time_since_epoch();
    const auto ms = duration_cast<std::chrono::milliseconds>(since).count() % 1000;
    nlohmann::ordered_json line = {
        {"time", fmt::format("{:%FT%T}.{:03}Z", fmt::gmtime(spdlog::log_clock::to_time_t(message.time)), ms)},
        {"level", view(spdlog::level::to_string_view(message.level))},
        {"program", view(message.logger_name)},
        {"message", view(message.payload)}};
    if (current != nullptr) {
      if (!current->job.empty()) line["job"] = current->job;
      if (current->task) line["task"] = *current->task;
      if (current->tile) line["tile"] = *current->tile;
      if (!current->worker.empty()) line["worker"] = current->worker;
    }
    // Names of files need not be UTF-8.
    const std::string text =
        line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonFormatter>(); }
};

}  // namespace

void start_log(const std::string& program, const std::string& level, LogFormat format,
               const std::vector<spdlog::sink_ptr>& others) {
  auto standard_error = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  standard_error->set_level(spdlog::level::from_str(level));
  if (format == LogFormat::kJson)
    standard_error->set_formatter(std::make_unique<JsonFormatter>());
  else
    standard_error->set_formatter(std::make_unique<TextFormatter>());
  std::vector<spdlog::sink_ptr> sinks = {standard_error};
  sinks.insert(sinks.end(), others.begin(), others.end());
  auto logger = std::make_shared<spdlog::logger>(program, sinks.begin(), sinks.end());
  spdlog::level::level_enum least = spdlog::level::off;
  for (const spdlog::sink_ptr& sink : sinks) least = std::min(least, sink->level());
  logger->set_level(least);
  spdlog::set_default_logger(std::move(logger));
}

void log_about(spdlog::level::level_enum level, const About& about, std::string_view text) {
  current = &about;
  spdlog::log(level, "{}", text);
  current = nullptr;
}

}  // namespace penumbra

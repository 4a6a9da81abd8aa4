#include "worker/agent/log_capture.h"

#include <fmt/format.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>

namespace penumbra {
namespace {

thread_local LogCapture* active = nullptr;

/// Touches nothing that threads share.
class CaptureSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
  void sink_it_(const spdlog::details::log_msg& message) override {
    if (active == nullptr) return;
    const spdlog::string_view_t level = spdlog::level::to_string_view(message.level);
    active->add({level.data(), level.size()}, {message.payload.data(), message.payload.size()});
  }
  void flush_() override {}
};

/// Where a character of UTF-8 begins, at or after `at`.
size_t character_from(const std::string& text, size_t at) {
  while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80) ++at;
  return at;
}

}  // namespace

LogCapture::LogCapture() {
  active = this;
}

LogCapture::~LogCapture() {
  active = nullptr;
}

void LogCapture::add(std::string_view level, std::string_view line) {
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - start_;
  text_ += fmt::format("{:.3f} {} {}\n", since.count(), level, line);
  if (text_.size() <= kMostBytes) return;
  // Whole lines go; of one that alone is too long, its beginning.
  const size_t least = text_.size() - kMostBytes;
  const size_t newline = text_.find('\n', least - 1);
  text_.erase(0, newline + 1 < text_.size() ? newline + 1 : character_from(text_, least));
}

spdlog::sink_ptr make_capture_sink() {
  auto sink = std::make_shared<CaptureSink>();
  sink->set_level(spdlog::level::debug);
  return sink;
}

}  // namespace penumbra

#pragma once
// What is logged while a thread renders a task, kept to be sent to the server: `penumbra logs` shows it, and
// nobody needs to know which host to look at.
#include <spdlog/common.h>

#include <chrono>
#include <string>

namespace penumbra {

/// While it lives, lines that its thread logs are kept too, with the seconds since it began. Not nested.
class LogCapture {
 public:
  /// The tail that is kept. A task says a few lines; one that says more has said what matters last.
  static constexpr size_t kMostBytes = 4096;

  LogCapture();
  ~LogCapture();
  LogCapture(const LogCapture&) = delete;

  const std::string& text() const { return text_; }
  void add(std::string_view level, std::string_view line);

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::string text_;
};

/// Hands each line to its thread's capture, from debug on.
spdlog::sink_ptr make_capture_sink();

}  // namespace penumbra

#pragma once
// How far a job is, on standard error: a bar that moves on a terminal, plain lines elsewhere.
#include <chrono>
#include <cstdint>
#include <string>

#include "proto/run.h"

namespace penumbra {

/// `0:07`, `12:40`, `1:02:03`.
std::string clock_text(double seconds);
/// One line of at most `width` columns: state, bar, share done, tasks, time left, workers.
std::string progress_bar(const JobStatus& status, int width);
/// The same without a bar, for a log.
std::string progress_line(const JobStatus& status);

class Progress {
 public:
  enum class Style { kSilent, kLines, kBar };
  explicit Progress(Style style) : style_(style) {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// A bar if standard error is a terminal.
  static Style style_for(bool quiet);

  void note(const std::string& text);  ///< a line that stays
  void uploading(uint64_t sent, uint64_t total);
  void show(const JobStatus& status);
  void clear();  ///< removes the moving line

 private:
  void draw(const std::string& line);

  Style style_;
  bool drawn_ = false;
  JobState told_state_ = JobState::kQueued;
  int told_tenth_ = -1;
  std::chrono::steady_clock::time_point told_at_{};
};

}  // namespace penumbra

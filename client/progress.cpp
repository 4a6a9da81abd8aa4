#include "client/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace penumbra {
namespace {

constexpr std::chrono::seconds kMostSilence{10};

int terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

/// Where the run shall end, if the past is a guide; empty while there is no past.
std::string time_left(const JobStatus& s) {
  if (s.state != JobState::kRunning || s.fraction <= 0 || s.wall_seconds <= 0) return {};
  return clock_text(s.wall_seconds * (1 - s.fraction) / s.fraction);
}

std::string workers_text(const JobStatus& s) {
  return fmt::format("{} worker{}, {} thread{}", s.workers, s.workers == 1 ? "" : "s", s.cores,
                     s.cores == 1 ? "" : "s");
}

/// `width` cells, filled to an eighth of a cell.
std::string bar(double fraction, int width) {
  static constexpr const char* kEighths[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const auto eighths = static_cast<int>(std::floor(std::clamp(fraction, 0.0, 1.0) * width * 8));
  std::string text;
  for (int i = 0; i < eighths / 8; ++i) text += "█";
  text += kEighths[eighths % 8];
  for (int i = (eighths + 7) / 8; i < width; ++i) text += "·";
  return text;
}

}  // namespace

std::string clock_text(double seconds) {
  const auto s = static_cast<int64_t>(std::llround(std::max(0.0, seconds)));
  if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
  return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::string progress_bar(const JobStatus& s, int width) {
  const std::string left = time_left(s);
  std::string tail = fmt::format(" {:3.0f} %  {}/{} tiles", 100 * s.fraction, s.tasks_done, s.tasks_total);
  if (!left.empty()) tail += fmt::format("  {} left", left);
  const std::string workers = fmt::format("  {}", workers_text(s));
  const std::string head = fmt::format("{:9} ", name_of(s.state));
  constexpr int kShortestBar = 8, kLongestBar = 40;
  int room = width - static_cast<int>(head.size() + tail.size());
  if (room >= kShortestBar + static_cast<int>(workers.size())) {
    tail += workers;
    room -= static_cast<int>(workers.size());
  }
  if (room < kShortestBar) return (head + tail).substr(0, static_cast<size_t>(std::max(0, width)));
  return head + bar(s.fraction, std::min(room, kLongestBar)) + tail;
}

std::string progress_line(const JobStatus& s) {
  std::string line =
      fmt::format("{}: {:.0f} %, {}/{} tiles, {:.1f} CPU s", name_of(s.state), 100 * s.fraction, s.tasks_done,
                  s.tasks_total, s.state == JobState::kPilot ? s.pilot_cpu_seconds : s.cpu_seconds);
  if (const std::string left = time_left(s); !left.empty()) line += fmt::format(", {} left", left);
  line += ", " + workers_text(s);
  if (!s.message.empty()) line += ": " + s.message;
  return line;
}

Progress::Style Progress::style_for(bool quiet) {
  if (quiet) return Style::kSilent;
  return isatty(STDERR_FILENO) == 1 ? Style::kBar : Style::kLines;
}

void Progress::note(const std::string& text) {
  if (style_ == Style::kSilent) return;
  clear();
  fmt::print(stderr, "{}\n", text);
}

void Progress::uploading(uint64_t sent, uint64_t total) {
  if (style_ != Style::kBar || total == 0) return;
  constexpr double kMiB = 1 << 20;
  draw(fmt::format("uploading {} {:.1f} of {:.1f} MiB",
                   bar(static_cast<double>(sent) / static_cast<double>(total), 30),
                   static_cast<double>(sent) / kMiB, static_cast<double>(total) / kMiB));
}

void Progress::show(const JobStatus& s) {
  if (style_ == Style::kBar) draw(progress_bar(s, terminal_width() - 1));
  if (style_ != Style::kLines) return;
  const auto now = std::chrono::steady_clock::now();
  const int tenth = static_cast<int>(s.fraction * 10);
  if (s.state == told_state_ && tenth == told_tenth_ && now - told_at_ < kMostSilence) return;
  told_state_ = s.state;
  told_tenth_ = tenth;
  told_at_ = now;
  fmt::print(stderr, "{}\n", progress_line(s));
}

void Progress::draw(const std::string& line) {
  fmt::print(stderr, "\r{}\x1b[K", line);
  std::fflush(stderr);
  drawn_ = true;
}

void Progress::clear() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace penumbra

#include "client/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace penumbra {
namespace {

using testing::HasSubstr;
using testing::Not;

JobStatus running() {
  JobStatus s;
  s.state = JobState::kRunning;
  s.fraction = 0.25;
  s.tasks_done = 16;
  s.tasks_total = 64;
  s.wall_seconds = 10;
  s.cpu_seconds = 19.5;
  s.workers = 2;
  s.cores = 4;
  return s;
}

int columns(const std::string& text) {
  int n = 0;
  for (const char c : text) n += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  return n;
}

TEST(Clock, ReadsLikeAClock) {
  EXPECT_EQ(clock_text(7.4), "0:07");
  EXPECT_EQ(clock_text(59.6), "1:00");
  EXPECT_EQ(clock_text(760), "12:40");
  EXPECT_EQ(clock_text(3723), "1:02:03");
}

TEST(ProgressBar, TellsShareAndTimeLeft) {
  const std::string bar = progress_bar(running(), 100);
  EXPECT_THAT(bar, HasSubstr("running"));
  EXPECT_THAT(bar, HasSubstr(" 25 %"));
  EXPECT_THAT(bar, HasSubstr("16/64 tiles"));
  EXPECT_THAT(bar, HasSubstr("0:30 left"));
  EXPECT_THAT(bar, HasSubstr("2 workers, 4 threads"));
}

TEST(ProgressBar, NeverIsWiderThanTheTerminal) {
  JobStatus s = running();
  for (int width = 1; width < 140; ++width)
    for (const double f : {0.0, 0.033, 0.5, 1.0}) {
      s.fraction = f;
      EXPECT_LE(columns(progress_bar(s, width)), width) << f;
    }
}

TEST(ProgressBar, HasNoTimeLeftBeforeTheRun) {
  JobStatus s = running();
  s.state = JobState::kPilot;
  EXPECT_THAT(progress_bar(s, 100), Not(HasSubstr("left")));
  s.state = JobState::kRunning;
  s.fraction = 0;
  EXPECT_THAT(progress_bar(s, 100), Not(HasSubstr("left")));
}

TEST(ProgressLine, IsForLogs) {
  JobStatus s = running();
  s.message = "waiting for blobs";
  EXPECT_EQ(progress_line(s),
            "running: 25 %, 16/64 tiles, 19.5 CPU s, 0:30 left, 2 workers, 4 threads: waiting for blobs");
}

}  // namespace
}  // namespace penumbra

#include "worker/agent/log_capture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <thread>

#include "proto/log.h"

namespace penumbra {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

class LogCaptureTest : public testing::Test {
 protected:
  void SetUp() override { start_log("test", "off", LogFormat::kText, {make_capture_sink()}); }
};

TEST_F(LogCaptureTest, KeepsWhatItsThreadLogsFromDebugOn) {
  spdlog::warn("before");
  std::string kept;
  {
    const LogCapture capture;
    log_about(spdlog::level::debug, {"j1", 3, 1, "h/w"}, "rendered");
    spdlog::trace("too fine");
    std::thread([] { spdlog::error("another thread's"); }).join();
    kept = capture.text();
  }
  spdlog::warn("after");
  EXPECT_THAT(kept, MatchesRegex("[0-9]\\.[0-9]+ debug rendered\n"));
  const LogCapture next;
  EXPECT_EQ(next.text(), "");
}

TEST_F(LogCaptureTest, KeepsTheTailInWholeLines) {
  const LogCapture capture;
  for (int i = 0; i < 1000; ++i) spdlog::info("line {} ende", i);
  EXPECT_LE(capture.text().size(), LogCapture::kMostBytes);
  EXPECT_GT(capture.text().size(), LogCapture::kMostBytes - 40);
  EXPECT_THAT(capture.text().substr(0, capture.text().find('\n')),
              MatchesRegex("[0-9]\\.[0-9]+ info line [0-9]+ ende"));
  EXPECT_THAT(capture.text(), HasSubstr("line 999 ende\n"));
}

TEST_F(LogCaptureTest, CutsALongLineBetweenCharacters) {
  const LogCapture capture;
  std::string line;
  while (line.size() < 3 * LogCapture::kMostBytes) line += "\u00e4";  // two bytes
  spdlog::info("{}", line + "!");
  EXPECT_LE(capture.text().size(), LogCapture::kMostBytes);
  EXPECT_EQ(capture.text().substr(0, 2), "\u00e4");
  EXPECT_EQ(capture.text().substr(capture.text().size() - 2), "!\n");
}

}  // namespace
}  // namespace penumbra

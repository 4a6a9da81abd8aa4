#include "client/retry.h"

#include <gtest/gtest.h>

#include <thread>

namespace penumbra {
namespace {

using namespace std::chrono_literals;

const RetryPolicy kQuick{30ms, 1ms, 4ms};

TEST(Retry, GivesUpAfterItsPatience) {
  Retry retry("host:1", {}, {}, kQuick);
  const auto begin = Retry::Clock::now();
  absl::Status status;
  while (status.ok()) status = retry.after(absl::UnavailableError("connection refused"));
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(message_of(status), "server host:1 is unreachable: connection refused");
  EXPECT_GE(Retry::Clock::now() - begin, 30ms);
}

TEST(Retry, AnAnswerRenewsPatience) {
  Retry retry("host:1", {}, {}, kQuick);
  const auto begin = Retry::Clock::now();
  while (Retry::Clock::now() - begin < 60ms) {
    ASSERT_TRUE(retry.after(absl::UnavailableError("")).ok());
    retry.answered();
  }
}

TEST(Retry, OnlyForServersThatDoNotAnswer) {
  Retry retry("host:1", {}, {}, kQuick);
  EXPECT_EQ(retry.after(absl::InvalidArgumentError("x")).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(retry.after(absl::NotFoundError("x")).code(), absl::StatusCode::kNotFound);
}

TEST(Retry, ADeadServersCheckEndsIt) {
  Retry retry(
      "host:1", [] { return absl::AbortedError("the local server ended"); }, {}, kQuick);
  EXPECT_EQ(retry.after(absl::UnavailableError("")).code(), absl::StatusCode::kAborted);
}

TEST(Retry, AStopCutsThePauseShort) {
  std::stop_source source;
  Retry retry("host:1", {}, source.get_token(), {1h, 1h, 1h});
  std::jthread stopper([&] {
    std::this_thread::sleep_for(20ms);
    source.request_stop();
  });
  EXPECT_EQ(retry.after(absl::UnavailableError("")).code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace penumbra

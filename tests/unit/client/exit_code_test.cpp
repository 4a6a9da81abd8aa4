#include "client/exit_code.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

TEST(ExitCodes, OfStatuses) {
  EXPECT_EQ(exit_code(absl::OkStatus()), 0);
  EXPECT_EQ(exit_code(absl::AbortedError("")), 1);
  EXPECT_EQ(exit_code(absl::ResourceExhaustedError("disk full")), 1);
  EXPECT_EQ(exit_code(absl::InvalidArgumentError("")), 2);
  EXPECT_EQ(exit_code(absl::NotFoundError("")), 2);
  EXPECT_EQ(exit_code(absl::UnavailableError("")), 5);
  EXPECT_EQ(exit_code(absl::CancelledError("")), 130);
}

TEST(ExitCodes, OfJobs) {
  JobStatus status;
  status.state = JobState::kDone;
  EXPECT_EQ(exit_code(status), 0);
  status.state = JobState::kCancelled;
  EXPECT_EQ(exit_code(status), 1);
  status.state = JobState::kFailed;
  status.failure = FailureKind::kJobFailed;
  EXPECT_EQ(exit_code(status), 1);
  status.failure = FailureKind::kBadInput;
  EXPECT_EQ(exit_code(status), 2);
}

}  // namespace
}  // namespace penumbra

#include "proto/run.h"

#include <cstdlib>

namespace penumbra {

std::string_view name_of(JobState state) {
  switch (state) {
    case JobState::kQueued:
      return "queued";
    case JobState::kPilot:
      return "pilot";
    case JobState::kRunning:
      return "running";
    case JobState::kDone:
      return "done";
    case JobState::kFailed:
      return "failed";
    case JobState::kCancelled:
      return "cancelled";
  }
  std::abort();
}

}  // namespace penumbra

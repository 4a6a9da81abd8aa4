#include "proto/lock_order.h"

#include "absl/synchronization/mutex.h"

namespace penumbra {

void ignore_lock_order() {
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
}

}  // namespace penumbra

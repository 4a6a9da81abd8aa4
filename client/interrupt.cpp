#include "client/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <thread>

#include "client/exit_code.h"
#include "proto/status.h"

namespace penumbra {

Interrupt::Interrupt() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  PENUMBRA_CHECK(pthread_sigmask(SIG_BLOCK, &signals, nullptr) == 0);
  signal(SIGPIPE, SIG_IGN);  // a reader of ours that has gone is a failed write, not our end
  // Lives as long as the process: it has nothing to finish.
  std::thread([signals, source = source_]() mutable {
    for (int received = 0;;) {
      int number = 0;
      if (sigwait(&signals, &number) != 0) continue;
      if (received++ > 0) _exit(kExitInterrupted);
      source.request_stop();
    }
  }).detach();
}

}  // namespace penumbra

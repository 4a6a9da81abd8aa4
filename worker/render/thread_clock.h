#pragma once
#include <time.h>

namespace penumbra {

/// CPU time of the calling thread: the clock of every cost figure (design §7).
inline double thread_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

}  // namespace penumbra

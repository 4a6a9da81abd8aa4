#include "worker/render/calibration.h"

#include <array>
#include <cmath>
#include <cstdint>

#include "worker/render/thread_clock.h"

namespace penumbra {
namespace {

// About 0.1 ms: long against the clock's resolution, short against a slice.
constexpr int kSteps = 6144;
// 16 KiB with the two tables.
constexpr uint32_t kEntries = 1024;
constexpr double kEverySeconds = 0.015;

struct Tables {
  std::array<uint32_t, kEntries> next;
  std::array<double, kEntries> value;
};

/// Sattolo's shuffle: one cycle through all entries, so that loads depend on each other.
Tables make_tables() {
  Tables t;
  for (uint32_t i = 0; i < kEntries; ++i) {
    t.next[i] = i;
    t.value[i] = 1 + double(i) / kEntries;
  }
  uint64_t state = 1;
  for (uint32_t i = kEntries - 1; i > 0; --i) {
    state = state * 6364136223846793005u + 1442695040888963407u;  // Knuth's MMIX
    std::swap(t.next[i], t.next[(state >> 33) % i]);
  }
  return t;
}

}  // namespace

double calibration_unit() {
  static const Tables tables = make_tables();
  uint32_t at = 0;
  double x = 1;
  for (int i = 0; i < kSteps; ++i) {
    at = tables.next[at];
    x = std::sqrt(x + tables.value[at]) + tables.value[at] / (1 + x);
  }
  return x;
}

void CalibrationClock::before_slice(Calibration& into) {
  // The result must be seen to be used, or the loop is nothing to a compiler.
  volatile double sink = 0;
  if (thread_cpu_seconds() - last_ < kEverySeconds) return;
  // The first one makes the tables, and finds caches cold and the clock low: not timed.
  if (std::isinf(last_)) sink = calibration_unit();
  const double start = thread_cpu_seconds();
  sink = calibration_unit();
  (void)sink;
  last_ = thread_cpu_seconds();
  ++into.units;
  into.seconds += last_ - start;
}

}  // namespace penumbra

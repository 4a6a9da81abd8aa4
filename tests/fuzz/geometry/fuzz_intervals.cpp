// IntervalSet::subtract against a grid of cells, for any sequence of cuts.
#include <array>
#include <cstdint>

#include "proto/status.h"
#include "worker/geometry/intervals.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr int kCells = 255;
  std::array<bool, kCells> visible;
  visible.fill(true);
  penumbra::IntervalSet set;
  set.reset(0, kCells);
  for (size_t i = 0; i + 1 < size; i += 2) {
    const int lo = data[i], hi = data[i + 1];
    bool changes = false;
    for (int cell = lo; cell < hi; ++cell) {
      changes |= visible[cell];
      visible[cell] = false;
    }
    PENUMBRA_CHECK(set.subtract(static_cast<float>(lo), static_cast<float>(hi)) == changes);
  }
  penumbra::IntervalSet expected;
  for (int cell = 0; cell < kCells; ++cell) {
    if (visible[cell]) expected.append(static_cast<float>(cell), static_cast<float>(cell + 1));
  }
  PENUMBRA_CHECK(set == expected);
  return 0;
}

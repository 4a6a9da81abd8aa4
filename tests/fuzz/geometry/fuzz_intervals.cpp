// IntervalSet::subtract against a grid of cells, for any sequence of cuts.
#include <bitset>
#include <cstdint>

#include "proto/status.h"
#include "worker/geometry/intervals.h"

namespace {

constexpr int kCells = 255;
using Cells =
    std::bitset<kCells>;  // whole words at a time: the grid is not to take longer than what it judges

Cells from(int cell) {
  return ~Cells() << static_cast<size_t>(cell);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Cells visible;
  visible.set();
  penumbra::IntervalSet set;
  set.reset(0, kCells);
  for (size_t i = 0; i + 1 < size; i += 2) {
    const int lo = data[i], hi = data[i + 1];
    const Cells cut = from(lo) & ~from(hi);
    PENUMBRA_CHECK(set.subtract(static_cast<float>(lo), static_cast<float>(hi)) == (visible & cut).any());
    visible &= ~cut;
  }
  penumbra::IntervalSet expected;
  for (int cell = 0; cell < kCells; ++cell) {
    if (visible[static_cast<size_t>(cell)])
      expected.append(static_cast<float>(cell), static_cast<float>(cell + 1));
  }
  PENUMBRA_CHECK(set == expected);
  return 0;
}

// chaos_drill --seconds N --seed S: faults for N seconds, then the audit. 100 faults are injected in three
// minutes at least; the same seed draws the same kinds in the same order.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/system/chaos/drill.h"

namespace penumbra {
namespace {

double seconds = 20;
uint64_t seed = 1;

TEST(Chaos, NothingIsLostOrDoneTwice) {
  ASSERT_FALSE(calm().mean.empty());
  Drill drill(seed);
  drill.run(seconds);
  drill.settle();
  std::printf("seed %llu: %s\n", static_cast<unsigned long long>(seed), drill.summary().c_str());
  EXPECT_GE(drill.faults(), seconds * 100 / 180);
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string flag = argv[i];
    if (flag == "--seconds") penumbra::seconds = std::atof(argv[i + 1]);
    if (flag == "--seed") penumbra::seed = std::strtoull(argv[i + 1], nullptr, 10);
  }
  return RUN_ALL_TESTS();
}

// Runs every family of the battery and prints one table of worst errors; failures, and nothing else, above
// it.
//   PENUMBRA_NUMERICS_DIR=DIR build/bin/numerics_table
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/numerics/csv.h"

namespace {

/// The failures without the listing of what passed.
class FailuresOnly : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (result.failed()) std::printf("%s\n", result.message());
  }
  void OnTestProgramEnd(const testing::UnitTest& all) override {
    std::printf("%d of %d families pass; battery %s\n", all.successful_test_count(), all.test_to_run_count(),
                penumbra::numerics::battery_folder().c_str());
  }
};

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
  delete listeners.Release(listeners.default_result_printer());
  listeners.Append(new FailuresOnly);
  return RUN_ALL_TESTS();
}

#include "client/checkpoint_errors.h"

#include <gtest/gtest.h>

#include "sample_run.h"

namespace penumbra {
namespace {

FilmImage constant(float value) {
  FilmImage image;
  image.width = 32;
  image.height = 16;
  image.window = {0, 0, 32, 16};
  image.rgb.assign(3 * image.pixels(), value);
  return image;
}

TEST(CheckpointErrors, AreTakenAgainstTheReference) {
  const RunSummary summary = sample_run().summary;
  CheckpointErrors errors;
  errors.add(summary, 0, 0, constant(2), constant(1));
  errors.add(summary, 0, 1, constant(1), constant(1));
  const std::vector<CheckpointError> of = errors.of(0);
  ASSERT_EQ(of.size(), 2u);
  EXPECT_NEAR(*of[0].relmse, 1 / 1.01, 1e-12);
  EXPECT_TRUE(of[0].relmse_ci.has_value());
  EXPECT_EQ(*of[1].relmse, 0);
  EXPECT_FALSE(of[0].estimated_relmse.has_value());
  EXPECT_TRUE(errors.of(1).empty());
}

TEST(CheckpointErrors, WithoutReferenceFromTheNextImage) {
  const RunSummary summary = sample_run().summary;  // 16, then 64 passes
  CheckpointErrors errors;
  errors.add(summary, 1, 0, constant(2), {});
  errors.add(summary, 0, 0, constant(5), {});  // mixes come interleaved
  errors.add(summary, 1, 1, constant(1), {});
  const std::vector<CheckpointError> of = errors.of(1);
  ASSERT_EQ(of.size(), 2u);
  EXPECT_FALSE(of[0].relmse.has_value());
  EXPECT_NEAR(*of[0].estimated_relmse, 64.0 / 48 / 1.01, 1e-12);
  EXPECT_FALSE(of[1].estimated_relmse.has_value()) << "nothing follows it";
}

TEST(CheckpointErrors, OfWhatTheSummaryDoesNotHaveNothingIsKept) {
  const RunSummary summary = sample_run().summary;
  CheckpointErrors errors;
  errors.add(summary, 0, 2, constant(1), {});
  errors.add(summary, 0, -1, constant(1), {});
  errors.add(summary, 7, 0, constant(1), {});
  EXPECT_TRUE(errors.of(0).empty());
  EXPECT_TRUE(errors.of(7).empty());
}

}  // namespace
}  // namespace penumbra

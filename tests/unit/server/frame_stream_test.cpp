#include "server/frame_stream.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

v1::RunSummary summary_of(int rows) {
  v1::RunSummary summary;
  summary.set_worker_cpu_seconds(3);
  summary.add_mixes()->set_mix("sa:1");
  for (int row = 0; row < rows; ++row) summary.add_tiles()->set_passes(row);
  return summary;
}

TEST(FrameStream, PartsOfASummaryMergeIntoIt) {
  for (const int rows : {0, 1, 9, 10, 11, 35}) {
    const v1::RunSummary whole = summary_of(rows);
    v1::RunSummary merged;
    const std::vector<v1::RunSummary> parts = parts_of(whole, 10);
    EXPECT_EQ(parts.size(), static_cast<size_t>(std::max(1, (rows + 9) / 10)));
    for (const v1::RunSummary& part : parts) {
      EXPECT_LE(part.tiles_size(), 10);
      merged.MergeFrom(part);
    }
    EXPECT_EQ(merged.SerializeAsString(), whole.SerializeAsString());
  }
}

}  // namespace
}  // namespace penumbra

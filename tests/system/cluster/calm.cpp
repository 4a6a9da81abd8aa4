#include "tests/system/cluster/calm.h"

#include <gtest/gtest.h>

namespace penumbra {

std::string test_name() {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  return info == nullptr ? "drill" : info->name();
}

const Picture& calm() {
  static const Picture picture = [] {
    Cluster cluster("calm");
    cluster.start_server();
    cluster.start_worker();
    const JobId job = cluster.submit(cluster.spec(cluster.upload_scene("0")));
    EXPECT_EQ(cluster.wait_end(job).state, JobState::kDone);
    Picture out;
    cluster.fetch(job, out);
    return out;
  }();
  return picture;
}

RunSummary expect_calm(Cluster& cluster, const JobId& job, double seconds) {
  EXPECT_EQ(cluster.wait_end(job, seconds).state, JobState::kDone);
  Picture picture;
  RunSummary summary = cluster.fetch(job, picture);
  EXPECT_EQ(picture.mean.size(), calm().mean.size());
  EXPECT_EQ(picture.mean.at(0).size(), 96u * 64 * 3);
  EXPECT_TRUE(picture == calm()) << "pixels differ";
  for (const MixSummary& mix : summary.mixes) EXPECT_EQ(mix.passes, 32);
  return summary;
}

}  // namespace penumbra

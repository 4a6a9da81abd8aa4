#include "server/assembler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <random>

#include "server/planner.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

class AssemblerTest : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(root_);
    blobs_ = std::make_unique<BlobFolder>(*BlobFolder::open(root_));
    job_.spec.mixes = {*parse_mix("sa:1"), *parse_mix("bsdf:1")};
    job_.spec.width = 50;
    job_.spec.height = 40;
    job_.spec.crop = {1, 2, 49, 37};
    job_.spec.tile = 16;
    job_.spec.budget = SppBudget{64};
    job_.tiles = tiles_of(job_.spec);
    job_.plan = make_plan(job_.spec, {64, 40});
    job_.results.resize(task_count(*job_.plan, job_.tiles));
  }
  void TearDown() override { fs::remove_all(root_); }

  /// A result whose values depend on the task alone.
  void store(uint64_t index) {
    const TileTask task = run_task(job_.spec, *job_.plan, job_.tiles, 0, index);
    std::mt19937 random(static_cast<unsigned>(index));
    TileResult result;
    for (const PassRange& range : task.passes) {
      TilePixels pixels;
      pixels.rect = task.tile;
      pixels.passes = range.count();
      pixels.groups = range.count();
      const auto n = static_cast<size_t>(task.tile.area());
      for (size_t i = 0; i < 3 * n; ++i) {
        pixels.mean.push_back(std::uniform_real_distribution<float>()(random));
        pixels.m2.push_back(std::uniform_real_distribution<float>()(random));
      }
      pixels.cost.assign(n, 1);
      pixels.bins = job_.bins;
      for (size_t i = 0; i < 3 * n * static_cast<size_t>(job_.bins); ++i) {
        pixels.bin_mean.push_back(static_cast<float>(1 + i / (3 * n)));
        pixels.bin_m2.push_back(0);
      }
      result.mixes.push_back(std::move(pixels));
    }
    const std::string bytes = serialize(result);
    const Digest digest = sha256(bytes);
    ASSERT_TRUE(blobs_->put(digest, bytes).ok());
    job_.results[index] = digest;
  }

  std::vector<AssembledFrame> assembled(bool checkpoints, uint64_t memory = 1 << 30) {
    std::vector<AssembledFrame> frames;
    const absl::Status status =
        assemble(job_, *blobs_, checkpoints, memory, [&](const AssembledFrame& frame) {
          frames.push_back(frame);
          return absl::OkStatus();
        });
    EXPECT_TRUE(status.ok()) << status;
    return frames;
  }

  fs::path root_;
  std::unique_ptr<BlobFolder> blobs_;
  Assembly job_;
};

TEST_F(AssemblerTest, BitsDoNotDependOnArrivalOrMemory) {
  std::vector<uint64_t> order(job_.results.size());
  std::iota(order.begin(), order.end(), 0);
  for (const uint64_t index : order) store(index);
  const auto first = assembled(true);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  std::fill(job_.results.begin(), job_.results.end(), "");
  for (const uint64_t index : order) store(index);
  auto second = assembled(true, 1);  // one mix at a time
  ASSERT_EQ(first.size(), second.size());
  std::stable_sort(second.begin(), second.end(), [](const AssembledFrame& a, const AssembledFrame& b) {
    return std::pair(a.checkpoint, a.mix) < std::pair(b.checkpoint, b.mix);
  });
  for (size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].mix, second[i].mix);
    EXPECT_EQ(first[i].checkpoint, second[i].checkpoint);
    EXPECT_EQ(first[i].image.rgb, second[i].image.rgb);
    EXPECT_EQ(first[i].image.variance, second[i].image.variance);
  }
}

TEST_F(AssemblerTest, CheckpointsAscendAndTheLastIsFinal) {
  for (uint64_t index = 0; index < job_.results.size(); ++index) store(index);
  int64_t checkpoints = 0;
  for (const PassBoundary& boundary : job_.plan->boundaries) checkpoints += boundary.checkpoint;
  const auto frames = assembled(true);
  EXPECT_EQ(frames.size(), 2 * static_cast<size_t>(checkpoints));
  for (const AssembledFrame& frame : frames) EXPECT_EQ(frame.final, frame.checkpoint == checkpoints - 1);
  EXPECT_EQ(frames.back().image.samples.front(), 40);
  EXPECT_EQ(assembled(false).size(), 2u);
}

TEST_F(AssemblerTest, AnUnfinishedJobShowsWhatThereIs) {
  store(0);
  const auto frames = assembled(true);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_TRUE(frames[0].final);
  EXPECT_EQ(frames[0].checkpoint, -1);
  EXPECT_GT(frames[0].image.samples.front(), 0);
  EXPECT_EQ(frames[0].image.samples.back(), 0);
  job_.plan.reset();
  job_.results.clear();
  EXPECT_EQ(assembled(true).size(), 2u);
}

TEST_F(AssemblerTest, ALostBlobIsAnError) {
  for (uint64_t index = 0; index < job_.results.size(); ++index) store(index);
  fs::remove(blobs_->path_of(job_.results[3]));
  const auto ignore = [](const AssembledFrame&) { return absl::OkStatus(); };
  EXPECT_FALSE(assemble(job_, *blobs_, false, 1 << 30, ignore).ok());
}

TEST_F(AssemblerTest, BinsComeBehindTheirPictureWhateverTheMemory) {
  job_.bins = 3;
  for (uint64_t i = 0; i < job_.results.size(); ++i) store(i);
  for (const uint64_t memory : {uint64_t{1}, uint64_t{1} << 30}) {
    const std::vector<AssembledFrame> frames = assembled(true, memory);
    std::vector<AssembledFrame> final;
    for (const AssembledFrame& frame : frames) {
      EXPECT_TRUE(frame.final || !frame.bin) << "a bin at a checkpoint";
      if (frame.final) final.push_back(frame);
    }
    ASSERT_EQ(final.size(), 8u);
    for (int m = 0; m < 2; ++m) {
      EXPECT_FALSE(final[4 * m].bin);
      for (int b = 0; b < 3; ++b) {
        const AssembledFrame& frame = final[4 * m + 1 + b];
        EXPECT_EQ(frame.mix, m);
        EXPECT_EQ(frame.bin, b);
        EXPECT_FLOAT_EQ(frame.image.rgb[100], static_cast<float>(1 + b));
      }
    }
  }
}

}  // namespace
}  // namespace penumbra

#include "proto/blob_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

namespace penumbra {
namespace {

namespace fs = std::filesystem;

class BlobFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    root_ = fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(root_);
    auto folder = BlobFolder::open(root_);
    ASSERT_TRUE(folder.ok()) << folder.status();
    folder_ = std::make_unique<BlobFolder>(*std::move(folder));
  }
  void TearDown() override { fs::remove_all(root_); }
  static Digest digest_of(std::string_view bytes) { return sha256(bytes); }

  fs::path root_;
  std::unique_ptr<BlobFolder> folder_;
};

TEST_F(BlobFolderTest, KnownDigest) {
  // FIPS 180-2, appendix B.1.
  EXPECT_EQ(digest_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_F(BlobFolderTest, KeepsWhatItIsGiven) {
  const std::string bytes(3 << 20, 'x');
  const Digest digest = digest_of(bytes);
  EXPECT_FALSE(folder_->size(digest));
  ASSERT_TRUE(folder_->put(digest, bytes).ok());
  ASSERT_TRUE(folder_->put(digest, bytes).ok());
  ASSERT_TRUE(folder_->sync({digest}).ok());
  EXPECT_EQ(folder_->size(digest), bytes.size());
  EXPECT_EQ(*folder_->read(digest), bytes);
  EXPECT_EQ(folder_->path_of(digest), (root_ / digest.substr(0, 2) / digest).string());
}

TEST_F(BlobFolderTest, BadNamesAndDigestsAreRefused) {
  for (const std::string& name : {std::string("../../etc/passwd"), std::string(), std::string(64, 'A'),
                                  std::string(63, 'a'), std::string(64, '/')}) {
    EXPECT_FALSE(is_digest(name));
    EXPECT_TRUE(absl::IsInvalidArgument(folder_->put(name, "x")));
    EXPECT_TRUE(absl::IsInvalidArgument(folder_->write(name, 1, 0).status()));
  }
  EXPECT_TRUE(absl::IsInvalidArgument(folder_->put(digest_of("a"), "b")));
  EXPECT_FALSE(folder_->size(digest_of("a")));
}

TEST_F(BlobFolderTest, CorruptionIsNoticedAndRemoved) {
  const Digest digest = digest_of("good");
  ASSERT_TRUE(folder_->put(digest, "good").ok());
  std::ofstream(folder_->path_of(digest)) << "evil";
  EXPECT_TRUE(absl::IsDataLoss(folder_->read(digest).status()));
  EXPECT_TRUE(absl::IsNotFound(folder_->read(digest).status()));
  ASSERT_TRUE(folder_->put(digest, "good").ok());
  EXPECT_EQ(*folder_->read(digest), "good");
}

TEST_F(BlobFolderTest, AWriterGoesOnWhereAnotherStopped) {
  const std::string bytes = "0123456789";
  const Digest digest = digest_of(bytes);
  {
    auto writer = folder_->write(digest, bytes.size(), 0);
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE((*writer)->append("0123").ok());
    EXPECT_TRUE(absl::IsAborted(folder_->write(digest, bytes.size(), 0).status()));
  }
  EXPECT_EQ(folder_->partial(digest), 4u);
  EXPECT_FALSE(folder_->size(digest));
  EXPECT_TRUE(absl::IsFailedPrecondition(folder_->write(digest, bytes.size(), 5).status()));
  auto writer = folder_->write(digest, bytes.size(), 4);
  ASSERT_TRUE(writer.ok()) << writer.status();
  ASSERT_TRUE((*writer)->append("456789").ok());
  ASSERT_TRUE((*writer)->finish().ok());
  EXPECT_EQ(*folder_->read(digest), bytes);
  EXPECT_EQ(folder_->partial(digest), 0u);
}

TEST_F(BlobFolderTest, AWriterRefusesWrongBytesAndSizes) {
  const Digest digest = digest_of("right");
  auto writer = folder_->write(digest, 5, 0);
  ASSERT_TRUE(writer.ok());
  EXPECT_TRUE(absl::IsInvalidArgument((*writer)->append("too long")));
  ASSERT_TRUE((*writer)->append("wron").ok());
  EXPECT_TRUE(absl::IsInvalidArgument((*writer)->finish()));
  ASSERT_TRUE((*writer)->append("g").ok());
  EXPECT_TRUE(absl::IsInvalidArgument((*writer)->finish()));
  EXPECT_EQ(folder_->partial(digest), 0u);
  EXPECT_FALSE(folder_->size(digest));
}

TEST_F(BlobFolderTest, WritersOfOneBlobExcludeEachOther) {
  std::string bytes(1 << 16, '\0');
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7);
  const Digest digest = digest_of(bytes);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        auto writer = folder_->write(digest, bytes.size(), 0);
        if (!writer.ok()) continue;
        for (size_t at = 0; at < bytes.size(); at += 4096)
          ASSERT_TRUE((*writer)->append(std::string_view(bytes).substr(at, 4096)).ok());
        ASSERT_TRUE((*writer)->finish().ok());
        const auto read = folder_->read(digest);
        ASSERT_TRUE(read.ok()) << read.status();
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(*folder_->read(digest), bytes);
}

}  // namespace
}  // namespace penumbra

#include "film/atomic_file.h"

#include <unistd.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class AtomicFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("penumbra_atomic_file_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

TEST_F(AtomicFile, WritesAndReplaces) {
  const fs::path path = folder_ / "a.json";
  ASSERT_TRUE(write_file_atomically(path, "one").ok());
  ASSERT_TRUE(write_file_atomically(path, "two").ok());
  EXPECT_EQ(content(path), "two");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(AtomicFile, AMissingFolderIsNamed) {
  const absl::Status status = write_file_atomically(folder_ / "no" / "a.json", "x");
  ASSERT_FALSE(status.ok());
  EXPECT_NE(message_of(status).find("no/a.json"), std::string::npos);
}

TEST_F(AtomicFile, AFailureLeavesNothingBehind) {
  fs::create_directory(folder_ / "taken");  // a folder cannot be replaced by a file
  EXPECT_FALSE(write_file_atomically(folder_ / "taken", "x").ok());
  EXPECT_TRUE(fs::is_directory(folder_ / "taken"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST(AtomicFileOnAFullDisk, IsAnErrorThatNamesThePath) {
  // /dev/full cannot be opened under another name; a partial file that is a link to it can.
  const fs::path folder = fs::path(testing::TempDir()) / ("penumbra_full_disk_" + std::to_string(getpid()));
  fs::remove_all(folder);
  fs::create_directory(folder);
  fs::create_symlink("/dev/full", folder / "a.exr.partial");
  const absl::Status status = write_file_atomically(folder / "a.exr", "bytes");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_NE(message_of(status).find("a.exr: cannot write: No space left"), std::string::npos)
      << message_of(status);
  EXPECT_FALSE(fs::exists(folder / "a.exr"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace penumbra

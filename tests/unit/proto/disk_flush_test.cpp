#include "proto/disk_flush.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <thread>

namespace penumbra {
namespace {

class DiskFlushTest : public testing::Test {
 protected:
  DiskFlushTest() : folder_(testing::TempDir() + "/disk-flush-" + std::to_string(getpid())) {
    std::filesystem::create_directories(folder_);
    flush_ = DiskFlush::open(folder_).value();
  }
  ~DiskFlushTest() override { std::filesystem::remove_all(folder_); }

  std::string file(const std::string& name) {
    std::ofstream(folder_ + "/" + name) << name;
    return folder_ + "/" + name;
  }

  std::string folder_;
  std::shared_ptr<DiskFlush> flush_;
};

TEST_F(DiskFlushTest, OneOrManyFilesOrNone) {
  EXPECT_TRUE(flush_->flush({}).ok());
  EXPECT_TRUE(flush_->flush({file("a")}).ok());
  EXPECT_TRUE(flush_->flush({file("a"), file("b")}).ok());
}

// Many are flushed with the whole disk, which knows no names: what is not there must be noticed all the same.
TEST_F(DiskFlushTest, AFileThatIsNotThereIsNamed) {
  for (const std::vector<std::string>& files :
       {std::vector{folder_ + "/gone"}, std::vector{file("a"), folder_ + "/gone"}}) {
    const absl::Status status = flush_->flush(files);
    EXPECT_TRUE(absl::IsNotFound(status)) << status;
    EXPECT_NE(status.message().find("gone"), std::string_view::npos) << status;
  }
  EXPECT_FALSE(DiskFlush::open(folder_ + "/gone").ok());
}

int flushes = 0, fails = 0;
int counted(int) {
  ++flushes;
  if (fails == 0) return 0;
  --fails;
  errno = EIO;
  return -1;
}

// The kernel tells of a failed write once only; whoever asks next must not take what was lost for kept.
TEST_F(DiskFlushTest, AFailureIsToldToAllWhoAskLater) {
  const auto flush = DiskFlush::open(folder_, counted).value();
  const std::vector<std::string> files = {file("a"), file("b")};
  flushes = 0, fails = 0;
  EXPECT_TRUE(flush->flush(files).ok());
  EXPECT_EQ(flushes, 1) << "both together";
  fails = 1;
  EXPECT_FALSE(flush->flush(files).ok());
  EXPECT_FALSE(flush->flush(files).ok());
  EXPECT_EQ(flushes, 2) << "a disk that has lost something is not asked again";
}

TEST_F(DiskFlushTest, WhoeverWaitsTogetherIsAnswered) {
  constexpr int kThreads = 8, kFlushes = 4;
  std::atomic<int> answered{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < kFlushes; ++i) {
        const std::string path = folder_ + "/" + std::to_string(t) + "-" + std::to_string(i);
        const int out = ::open(path.c_str(), O_RDWR | O_CREAT, 0644);
        EXPECT_EQ(::write(out, "x", 1), 1);
        if (flush_->flush(out, path).ok()) ++answered;
        ::close(out);
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(answered, kThreads * kFlushes);
}

}  // namespace
}  // namespace penumbra

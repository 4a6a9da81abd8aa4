#include "client/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "proto/status.h"

namespace penumbra {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class ChildProcessTest : public testing::Test {
 protected:
  ChildProcessTest() : log_(std::filesystem::path(testing::TempDir()) / ("penumbra_child_" + std::to_string(getpid()) + ".log")) {
    std::filesystem::remove(log_);
  }
  ~ChildProcessTest() override { std::filesystem::remove(log_); }
  ChildProcess shell(const std::string& script) {
    auto child = ChildProcess::start("/bin/sh", {"-c", script}, log_);
    EXPECT_TRUE(child.ok());
    return *std::move(child);
  }
  std::string log_;
};

TEST_F(ChildProcessTest, TellsHowItEndedAndKeepsItsLog) {
  ChildProcess child = shell("echo one; echo two >&2; echo three; exit 3");
  ASSERT_TRUE(child.wait_for(10s));
  EXPECT_EQ(child.ending(), "exit code 3");
  EXPECT_EQ(tail_of(log_, 2), "two\nthree\n");
}

TEST_F(ChildProcessTest, TerminateIsPoliteAndKillIsNot) {
  ChildProcess polite = shell("sleep 100");
  polite.terminate();
  ASSERT_TRUE(polite.wait_for(10s));
  EXPECT_THAT(polite.ending(), HasSubstr("signal 15"));

  ChildProcess deaf = shell("trap '' TERM; echo ready; while :; do sleep 0.05; done");
  while (tail_of(log_, 1) != "ready\n") std::this_thread::sleep_for(2ms);
  deaf.terminate();
  EXPECT_FALSE(deaf.wait_for(100ms));
  deaf.kill();
  EXPECT_THAT(deaf.ending(), HasSubstr("signal 9"));
}

TEST_F(ChildProcessTest, EndsWithItsObject) {
  pid_t pid = 0;
  {
    ChildProcess child = shell("sleep 100");
    pid = child.pid();
    ASSERT_EQ(kill(pid, 0), 0);
  }
  EXPECT_NE(kill(pid, 0), 0);
}

TEST_F(ChildProcessTest, DiesWithAParentThatIsKilled) {
  int pipe_ends[2];
  ASSERT_EQ(pipe(pipe_ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    auto child = ChildProcess::start("/bin/sleep", {"100"}, log_);
    const pid_t pid = child.ok() ? child->pid() : -1;
    if (write(pipe_ends[1], &pid, sizeof pid) != sizeof pid) _exit(1);
    pause();
    _exit(0);
  }
  pid_t grandchild = -1;
  ASSERT_EQ(read(pipe_ends[0], &grandchild, sizeof grandchild), static_cast<ssize_t>(sizeof grandchild));
  ASSERT_GT(grandchild, 0);
  // It is adopted by this process, so that its end can be seen even where nobody reaps orphans.
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  int status = 0;
  EXPECT_EQ(waitpid(grandchild, &status, 0), grandchild);
  // By the kernel, or by itself where the parent died before the child had asked the kernel for that;
  // never by the end of its sleep.
  const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
  EXPECT_TRUE(killed || (WIFEXITED(status) && WEXITSTATUS(status) == 127));
  close(pipe_ends[0]);
  close(pipe_ends[1]);
}

TEST_F(ChildProcessTest, AProgramThatIsNotThereEndsAtOnce) {
  auto child = ChildProcess::start("/no/such/program", {}, log_);
  ASSERT_TRUE(child.ok());
  ASSERT_TRUE(child->wait_for(10s));
  EXPECT_EQ(child->ending(), "exit code 127");
  EXPECT_THAT(message_of(program_beside_this("penumbra-nothing").status()),
              HasSubstr("penumbra-nothing: not found"));
}

}  // namespace
}  // namespace penumbra

#pragma once
#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace penumbra {

/// A child with its output in a log file. It is in a process group of its own (Ctrl-C in the terminal
/// reaches only us) and is killed by the kernel if this process dies without ending it.
class ChildProcess {
 public:
  /// Starts `program` (a path). Call from the main thread: the kernel ties the child to the thread.
  static absl::StatusOr<ChildProcess> start(const std::string& program,
                                            const std::vector<std::string>& arguments,
                                            const std::string& log);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  /// Kills what still runs.
  ~ChildProcess();

  bool running();
  /// How it ended ("exit code 3", "signal 11"); empty while it runs.
  const std::string& ending();
  void terminate();  ///< SIGTERM
  void kill();       ///< SIGKILL, and waits for it
  /// True if it has ended in time.
  bool wait_for(std::chrono::milliseconds time);
  pid_t pid() const { return pid_; }
  const std::string& log() const { return log_; }

 private:
  ChildProcess(pid_t pid, std::string log) : pid_(pid), log_(std::move(log)) {}
  pid_t pid_ = -1;  ///< -1: moved from or reaped
  std::string log_, ending_;
};

/// The last lines of a file, for messages; empty if it cannot be read.
std::string tail_of(const std::string& path, int lines);

/// Path of a program that lies beside this one. NotFound if there is none.
absl::StatusOr<std::string> program_beside_this(const std::string& name);

}  // namespace penumbra

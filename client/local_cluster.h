#pragma once
// A server and workers on this machine for the length of one run.
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/child_process.h"
#include "client/options.h"

namespace penumbra {

/// Lives in a temporary folder of its own (store, cache, logs). All processes end with this object.
class LocalCluster {
 public:
  /// Starts the server, waits until it listens, starts the workers.
  /// `programs`: a build's folder (with bin/), instead of the programs beside this one.
  static absl::StatusOr<LocalCluster> start(const ClusterSize& size, const std::string& programs = "");
  LocalCluster(LocalCluster&&) = default;
  LocalCluster& operator=(LocalCluster&&) = delete;
  ~LocalCluster();

  const std::string& address() const { return address_; }

  /// Looks after the processes: a worker that has ended is started again, a few times. An error (with
  /// the end of its log) if the server has ended, or workers keep ending.
  absl::Status tend();

  /// Asks all to end, kills those that do not within 5 s, removes the folder.
  void stop();

 private:
  LocalCluster() = default;
  absl::StatusOr<std::string> program(const std::string& name) const;
  absl::Status start_server();
  absl::Status start_worker(size_t index);

  ClusterSize size_;
  std::string programs_, folder_, address_;
  std::vector<ChildProcess> server_;  ///< none or one
  std::vector<ChildProcess> workers_;
  int restarts_ = 0;
};

}  // namespace penumbra

#pragma once
// A job's pictures in tev while they grow.
#include <stop_token>
#include <string>
#include <thread>

#include "client/server.h"
#include "client/tev.h"

namespace penumbra {

/// Fetches and shows in a thread of its own, so that a viewer that is slow holds up nobody. A viewer that
/// goes away is a note, not an error.
class Preview {
 public:
  Preview(Server& server, JobId job, Tev tev);
  /// Shows the last state and ends.
  ~Preview();

 private:
  void run(const std::stop_token& stop);
  absl::Status show_once();

  Server& server_;
  JobId job_;
  Tev tev_;
  std::jthread thread_;
};

}  // namespace penumbra

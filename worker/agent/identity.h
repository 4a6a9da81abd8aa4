#pragma once
// Who this worker is: the host, which of the host's workers, which incarnation.
#include <string>

#include "absl/status/statusor.h"
#include "proto/job.h"

namespace penumbra {

/// The lowest number that no other worker on this host with the same cache folder has, held as a file lock
/// that ends with the process, however it ends. So a worker that is started in place of a killed one gets
/// its number, and with it its identity, while workers side by side differ.
class Slot {
 public:
  /// Locks <cache>/slots/<number>. InvalidArgument if the folder cannot be used.
  static absl::StatusOr<Slot> take(const std::string& cache);
  Slot(Slot&& other) noexcept;
  Slot& operator=(Slot&&) = delete;
  ~Slot();
  int number() const { return number_; }

 private:
  Slot(int number, int lock) : number_(number), lock_(lock) {}
  int number_;
  int lock_;
};

/// Incarnation (a random UUID), host name, instruction set.
WorkerInfo make_worker_info(int threads);

/// User and system CPU seconds of this process.
double process_cpu_seconds();

}  // namespace penumbra

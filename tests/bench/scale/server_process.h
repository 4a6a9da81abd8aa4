#pragma once
// The server under load: a process of its own, with what the kernel says of it.
#include <sys/types.h>

#include <string>
#include <vector>

namespace penumbra {

class ServerProcess {
 public:
  /// Starts it on a free port with a store in `folder`, and waits until it listens.
  ServerProcess(const std::string& folder, const std::vector<std::string>& flags);
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;

  const std::string& address() const { return address_; }
  double cpu_seconds() const;     ///< user and system, all threads
  double resident_bytes() const;  ///< the most until now

 private:
  pid_t pid_;
  std::string address_;
};

}  // namespace penumbra

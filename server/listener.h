#pragma once
// The gRPC side of the server: one address, its credentials, the services behind it.
#include <grpcpp/server.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "proto/channel.h"

namespace penumbra {

struct Listener {
  std::unique_ptr<grpc::Server> server;
  std::string address;  ///< HOST:PORT with the port that was bound
};

/// Listens on `address` (port 0: any free one). InvalidArgument names the flag: a port in use, TLS files
/// that cannot be read, or an address other machines can reach without TLS and token.
absl::StatusOr<Listener> listen(const std::string& address, const Credentials& credentials,
                                const std::vector<grpc::Service*>& services);

}  // namespace penumbra

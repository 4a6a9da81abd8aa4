#pragma once
// The gRPC side of the server: one address, its credentials, the services behind it.
#include <grpcpp/server.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "proto/channel.h"
#include "server/token_file.h"

namespace penumbra {

struct Listener {
  std::unique_ptr<grpc::Server> server;
  std::string address;  ///< HOST:PORT with the port that was bound
};

struct ListenOptions {
  std::string address;  ///< HOST:PORT; port 0: any free one
  Credentials credentials;
  std::vector<TokenEntry> tokens;  ///< of credentials.token_file
  bool insecure = false;           ///< other machines may call without TLS and token
};

/// Listens. InvalidArgument names the flag: a port in use, TLS files that cannot be read, or an address
/// that other machines can reach without TLS and token.
absl::StatusOr<Listener> listen(const ListenOptions& options, const std::vector<grpc::Service*>& services);

}  // namespace penumbra

#pragma once
// How clients and workers reach the server: plain on loopback, TLS with client certificates elsewhere.
#include <grpcpp/channel.h>

#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace penumbra {

/// Paths of PEM files and of a file with a bearer token; all empty: no TLS, no token.
struct Credentials {
  std::string cert, key, ca, token_file;
  bool tls() const { return !cert.empty() || !key.empty() || !ca.empty(); }
};

/// Largest message that either side sends or takes: a sync with a full set of leases and reports stays
/// far below it; blobs and frames travel in chunks of kChunkBytes.
inline constexpr int kMostMessageBytes = 16 << 20;
inline constexpr size_t kChunkBytes = 1 << 20;

/// True for an address (HOST:PORT) that cannot be reached from another machine.
bool is_loopback(const std::string& address);

/// Reads a small text file (a certificate, a token); trailing newlines of a token are dropped by
/// read_token. InvalidArgument names the flag and the file.
absl::StatusOr<std::string> read_credential(const std::string& flag, const std::string& path);
absl::StatusOr<std::string> read_token(const std::string& path);

/// A channel to HOST:PORT that reconnects after at most a second. InvalidArgument if the flags do not
/// fit together or a file cannot be read. Does not wait for the connection.
absl::StatusOr<std::shared_ptr<grpc::Channel>> open_channel(const std::string& address,
                                                            const Credentials& credentials);

}  // namespace penumbra

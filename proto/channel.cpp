#include "proto/channel.h"

#include <arpa/inet.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "proto/lock_order.h"
#include "proto/status.h"

namespace penumbra {
namespace {

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> channel_credentials(const Credentials& c) {
  if (!c.tls()) {
    if (!c.token_file.empty())
      return invalid_input("--token-file: a token is only sent over TLS; give --tls-ca as well");
    return grpc::InsecureChannelCredentials();
  }
  if (c.cert.empty() != c.key.empty()) return invalid_input("--tls-cert and --tls-key go together");
  grpc::SslCredentialsOptions options;
  if (!c.ca.empty()) {
    ASSIGN_OR_RETURN(options.pem_root_certs, read_credential("--tls-ca", c.ca));
  }
  if (!c.cert.empty()) {
    ASSIGN_OR_RETURN(options.pem_cert_chain, read_credential("--tls-cert", c.cert));
    ASSIGN_OR_RETURN(options.pem_private_key, read_credential("--tls-key", c.key));
  }
  std::shared_ptr<grpc::ChannelCredentials> tls = grpc::SslCredentials(options);
  if (c.token_file.empty()) return tls;
  ASSIGN_OR_RETURN(const std::string token, read_token(c.token_file));
  return grpc::CompositeChannelCredentials(tls, grpc::AccessTokenCredentials(token));
}

}  // namespace

bool is_loopback(const std::string& address) {
  const std::string host = address.substr(0, address.rfind(':'));
  if (host == "localhost" || host == "[::1]") return true;
  in_addr ip{};  // 127.0.0.0/8; a name that merely begins with 127. is not an address
  return inet_pton(AF_INET, host.c_str(), &ip) == 1 && (ntohl(ip.s_addr) >> 24) == 127;
}

absl::StatusOr<std::string> read_credential(const std::string& flag, const std::string& path) {
  std::error_code error;
  constexpr uintmax_t kMostBytes = 1 << 20;  // a certificate chain has a few kilobytes
  const uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return invalid_input("{}: {}: {}", flag, path, error.message());
  if (size > kMostBytes) return invalid_input("{}: {}: larger than {} bytes", flag, path, kMostBytes);
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  if (!in) return invalid_input("{}: {}: cannot be read", flag, path);
  return text.str();
}

absl::StatusOr<std::string> read_token(const std::string& path) {
  ASSIGN_OR_RETURN(std::string token, read_credential("--token-file", path));
  while (!token.empty() && (token.back() == '\n' || token.back() == '\r')) token.pop_back();
  if (token.empty()) return invalid_input("--token-file: {}: holds no token", path);
  if (token.find_first_of(" \t\r\n") != std::string::npos)
    return invalid_input("--token-file: {}: holds more than one token; only the server's file may", path);
  return token;
}

absl::StatusOr<std::shared_ptr<grpc::Channel>> open_channel(const std::string& address,
                                                            const Credentials& credentials) {
  if (address.rfind(':') == std::string::npos)
    return invalid_input("--server: '{}' is not of the form HOST:PORT", address);
  ignore_lock_order();
  ASSIGN_OR_RETURN(const auto security, channel_credentials(credentials));
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 50);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 2000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetMaxReceiveMessageSize(kMostMessageBytes);
  arguments.SetMaxSendMessageSize(kMostMessageBytes);
  return grpc::CreateCustomChannel(address, security, arguments);
}

}  // namespace penumbra

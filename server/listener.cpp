#include "server/listener.h"

#include <fmt/format.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/security/auth_metadata_processor.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>
#include <openssl/crypto.h>

#include "proto/status.h"

namespace penumbra {
namespace {

/// Refuses calls without the right `authorization: Bearer TOKEN`. The comparison takes the same time
/// wherever the tokens differ.
class TokenProcessor final : public grpc::AuthMetadataProcessor {
 public:
  explicit TokenProcessor(const std::string& token) : expected_("Bearer " + token) {}
  bool IsBlocking() const override { return false; }
  grpc::Status Process(const InputMetadata& metadata, grpc::AuthContext*, OutputMetadata* consumed,
                       OutputMetadata*) override {
    const auto it = metadata.find("authorization");
    if (it == metadata.end() || it->second.size() != expected_.size() ||
        CRYPTO_memcmp(it->second.data(), expected_.data(), expected_.size()) != 0)
      return grpc::Status(grpc::StatusCode::UNAUTHENTICATED, "a valid token is wanted (--token-file)");
    consumed->insert({"authorization", std::string(it->second.data(), it->second.size())});
    return grpc::Status::OK;
  }

 private:
  std::string expected_;
};

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> server_credentials(const std::string& address,
                                                                            const Credentials& c) {
  if (!c.tls() && c.token_file.empty()) {
    if (is_loopback(address)) return grpc::InsecureServerCredentials();
    return invalid_input(
        "--listen {}: other machines can reach this address, so it needs --tls-cert, --tls-key, --tls-ca and "
        "--token-file",
        address);
  }
  if (c.cert.empty() || c.key.empty() || c.ca.empty() || c.token_file.empty())
    return invalid_input("--tls-cert, --tls-key, --tls-ca and --token-file go together");
  grpc::SslServerCredentialsOptions options(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  ASSIGN_OR_RETURN(options.pem_root_certs, read_credential("--tls-ca", c.ca));
  ASSIGN_OR_RETURN(std::string cert, read_credential("--tls-cert", c.cert));
  ASSIGN_OR_RETURN(std::string key, read_credential("--tls-key", c.key));
  options.pem_key_cert_pairs.push_back({std::move(key), std::move(cert)});
  ASSIGN_OR_RETURN(const std::string token, read_token(c.token_file));
  std::shared_ptr<grpc::ServerCredentials> credentials = grpc::SslServerCredentials(options);
  credentials->SetAuthMetadataProcessor(std::make_shared<TokenProcessor>(token));
  return credentials;
}

}  // namespace

absl::StatusOr<Listener> listen(const std::string& address, const Credentials& credentials,
                                const std::vector<grpc::Service*>& services) {
  const size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0)
    return invalid_input("--listen: '{}' is not of the form HOST:PORT", address);
  ASSIGN_OR_RETURN(const auto security, server_credentials(address, credentials));
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  // Two servers on one port would share its connections at random.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.SetMaxReceiveMessageSize(kMostMessageBytes);
  builder.SetMaxSendMessageSize(kMostMessageBytes);
  // Few threads that poll: with more, every message wakes several for nothing.
  builder.SetSyncServerOption(grpc::ServerBuilder::SyncServerOption::NUM_CQS, 1);
  builder.SetSyncServerOption(grpc::ServerBuilder::SyncServerOption::MIN_POLLERS, 1);
  builder.SetSyncServerOption(grpc::ServerBuilder::SyncServerOption::MAX_POLLERS, 2);
  int port = 0;
  builder.AddListeningPort(address, security, &port);
  for (grpc::Service* service : services) builder.RegisterService(service);
  Listener listener;
  listener.server = builder.BuildAndStart();
  if (listener.server == nullptr || port == 0)
    return invalid_input("--listen {}: cannot listen there; is the port in use?", address);
  listener.address = fmt::format("{}:{}", address.substr(0, colon), port);
  return listener;
}

}  // namespace penumbra

#include "server/listener.h"

#include <fmt/format.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/resource_quota.h>
#include <grpcpp/security/auth_metadata_processor.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <utility>

#include "proto/lock_order.h"
#include "proto/status.h"
#include "server/caller.h"

namespace penumbra {
namespace {

// Streams hold a thread each while they last (gRPC's synchronous services); Syncs hold none.
constexpr int kMostThreads = 512;

std::string_view view(grpc::string_ref text) {
  return {text.data(), text.size()};
}

/// So many requests a second, and as many again at once after a pause.
class TokenBucket {
 public:
  explicit TokenBucket(double per_second) : per_second_(per_second), left_(per_second) {}
  bool take() {
    if (per_second_ == 0) return true;
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> passed = now - std::exchange(last_, now);
    left_ = std::min(per_second_, left_ + passed.count() * per_second_);
    if (left_ < 1) return false;
    left_ -= 1;
    return true;
  }

 private:
  double per_second_;
  std::mutex mutex_;
  double left_;                                                                    // guarded by mutex_
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();  // guarded by mutex_
};

/// Refuses calls without a token of the right role, and those that come too fast.
class TokenProcessor final : public grpc::AuthMetadataProcessor {
 public:
  explicit TokenProcessor(std::vector<TokenEntry> entries) : entries_(std::move(entries)) {
    for (const TokenEntry& entry : entries_)
      buckets_.push_back(std::make_unique<TokenBucket>(entry.requests_per_second));
    whole_ = true;
  }
  bool IsBlocking() const override { return false; }

  grpc::Status Process(const InputMetadata& metadata, grpc::AuthContext* context, OutputMetadata* consumed,
                       OutputMetadata*) override {
    PENUMBRA_CHECK(whole_);
    constexpr std::string_view kBearer = "Bearer ";
    const auto authorization = metadata.find("authorization");
    const TokenEntry* entry = nullptr;
    if (authorization != metadata.end() && view(authorization->second).substr(0, kBearer.size()) == kBearer)
      entry = find_token(entries_, view(authorization->second).substr(kBearer.size()));
    if (entry == nullptr)
      return grpc::Status(grpc::StatusCode::UNAUTHENTICATED, "a valid token is wanted (--token-file)");
    const auto path = metadata.find(":path");
    const std::string_view method = path == metadata.end() ? std::string_view() : view(path->second);
    if (!allows(*entry, method))
      return grpc::Status(grpc::StatusCode::PERMISSION_DENIED,
                          fmt::format("the token of user '{}' does not allow {}", entry->user, method));
    if (!buckets_[static_cast<size_t>(entry - entries_.data())]->take())
      return grpc::Status(grpc::StatusCode::UNAVAILABLE,
                          fmt::format("user '{}' sends more than {} requests a second", entry->user,
                                      entry->requests_per_second));
    consumed->insert({"authorization", std::string(view(authorization->second))});
    context->AddProperty(kUserProperty, entry->user);
    if ((entry->roles & static_cast<uint8_t>(Role::kAdmin)) != 0) context->AddProperty(kAdminProperty, "1");
    return grpc::Status::OK;
  }

 private:
  std::vector<TokenEntry> entries_;
  std::vector<std::unique_ptr<TokenBucket>> buckets_;  ///< parallel to entries_
  /// Written last and read first: gRPC, whose threads may be older than this, orders the two as well, but
  /// unseen by those who look for races.
  std::atomic<bool> whole_{false};
};

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> server_credentials(const ListenOptions& o) {
  const Credentials& c = o.credentials;
  if (!c.tls() && c.token_file.empty()) {
    if (is_loopback(o.address) || o.insecure) return grpc::InsecureServerCredentials();
    return invalid_input(
        "--listen {}: other machines can reach this address, so it needs --tls-cert, --tls-key, --tls-ca and "
        "--token-file (or --insecure, where the network itself can be trusted)",
        o.address);
  }
  if (o.insecure)
    return invalid_input("--insecure excludes --tls-cert, --tls-key, --tls-ca and --token-file");
  if (c.cert.empty() || c.key.empty() || c.ca.empty() || c.token_file.empty())
    return invalid_input("--tls-cert, --tls-key, --tls-ca and --token-file go together");
  grpc::SslServerCredentialsOptions options(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  ASSIGN_OR_RETURN(options.pem_root_certs, read_credential("--tls-ca", c.ca));
  ASSIGN_OR_RETURN(std::string cert, read_credential("--tls-cert", c.cert));
  ASSIGN_OR_RETURN(std::string key, read_credential("--tls-key", c.key));
  options.pem_key_cert_pairs.push_back({std::move(key), std::move(cert)});
  std::shared_ptr<grpc::ServerCredentials> credentials = grpc::SslServerCredentials(options);
  credentials->SetAuthMetadataProcessor(std::make_shared<TokenProcessor>(o.tokens));
  return credentials;
}

}  // namespace

absl::StatusOr<Listener> listen(const ListenOptions& options, const std::vector<grpc::Service*>& services) {
  const std::string& address = options.address;
  const size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0)
    return invalid_input("--listen: '{}' is not of the form HOST:PORT", address);
  ignore_lock_order();
  ASSIGN_OR_RETURN(const auto security, server_credentials(options));
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  // Two servers on one port would share its connections at random.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.SetMaxReceiveMessageSize(kMostMessageBytes);
  builder.SetMaxSendMessageSize(kMostMessageBytes);
  // Callers in all, so that threads and memory stay bounded. gRPC refuses those beyond (is_overload), and
  // they try again.
  builder.SetResourceQuota(grpc::ResourceQuota("penumbra-server").SetMaxThreads(kMostThreads));
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

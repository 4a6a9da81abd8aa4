#include "server/http_server.h"

#include <civetweb.h>
#include <fmt/format.h>
#include <openssl/ssl.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <utility>

#include "proto/status.h"
#include "server/http_access.h"

namespace penumbra {
namespace {

// A viewer that reads or asks slowly holds a thread, for so long at most; the others must still be answered.
constexpr const char* kThreads = "16";
constexpr const char* kRequestTimeoutMs = "10000";
constexpr const char* kMostRequestBytes = "16384";  // line and headers

const char* reason(int code) {
  switch (code) {
    case 200:
      return "OK";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 500:
      return "Internal Server Error";
    case 503:
      return "Service Unavailable";
    default:
      return "Error";
  }
}

std::string_view header(mg_connection* connection, const char* name) {
  const char* value = mg_get_header(connection, name);
  return value == nullptr ? std::string_view() : std::string_view(value);
}

/// Pages load from this server alone, and no other site may show them in a frame.
void send(mg_connection* connection, const HttpReply& reply, bool body) {
  const std::string head = fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
      "X-Content-Type-Options: nosniff\r\nContent-Security-Policy: default-src 'self'; img-src 'self' data:; "
      "frame-ancestors 'none'\r\n{}Connection: close\r\n\r\n",
      reply.code, reason(reply.code), reply.type, reply.body.size(),
      reply.code == 401 ? "WWW-Authenticate: Basic realm=\"Penumbra: the token is the password\"\r\n" : "");
  mg_write(connection, head.data(), head.size());
  if (body) mg_write(connection, reply.body.data(), reply.body.size());
}

}  // namespace

struct HttpServer::Parts {
  Handler handler;
  HttpAccess access;
  std::string cert, key;  ///< paths
  mg_context* context = nullptr;

  ~Parts() {
    if (context != nullptr) mg_stop(context);
  }

  static HttpReply plain(int code) {
    return {code, "text/plain; charset=utf-8", fmt::format("{}\n", reason(code))};
  }

  /// Nothing that goes wrong for a viewer may end the coordinator.
  HttpReply handle(const HttpRequest& request) const {
    try {
      return handler(request);
    } catch (const std::exception& error) {
      spdlog::warn("http: {}: {}", request.path, error.what());
      return plain(500);
    }
  }

  /// civetweb's own complaints: mostly of peers that hung up, which anybody can make us write.
  static int log(const mg_connection*, const char* message) {
    spdlog::debug("http: {}", message);
    return 1;
  }

  static int answer(mg_connection* connection, void* self) {
    const Parts& parts = *static_cast<const Parts*>(self);
    const mg_request_info* info = mg_get_request_info(connection);
    const HttpRequest request{info->local_uri == nullptr ? "/" : info->local_uri,
                              info->query_string == nullptr ? "" : info->query_string};
    const HttpHeaders headers{info->request_method, header(connection, "Host"),
                              header(connection, "Authorization")};
    const std::optional<int> refused = refusal(parts.access, request.path, headers);
    const HttpReply reply = refused ? plain(*refused) : parts.handle(request);
    send(connection, reply, headers.method != "HEAD");
    return reply.code;
  }

  /// Certificate and key are files of their own, which civetweb's options do not have.
  static int init_tls(void* tls, void* self) {
    const Parts& parts = *static_cast<const Parts*>(self);
    auto* context = static_cast<SSL_CTX*>(tls);
    SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
    const bool loaded = SSL_CTX_use_certificate_chain_file(context, parts.cert.c_str()) == 1 &&
                        SSL_CTX_use_PrivateKey_file(context, parts.key.c_str(), SSL_FILETYPE_PEM) == 1 &&
                        SSL_CTX_check_private_key(context) == 1;
    return loaded ? 1 : -1;
  }
};

HttpServer::HttpServer() = default;
HttpServer::HttpServer(HttpServer&&) noexcept = default;
HttpServer& HttpServer::operator=(HttpServer&&) noexcept = default;
HttpServer::~HttpServer() = default;

std::string HttpRequest::variable(const std::string& name) const {
  char value[256];
  const int length = mg_get_var(query.data(), query.size(), name.c_str(), value, sizeof value);
  return length > 0 ? std::string(value, static_cast<size_t>(length)) : std::string();
}

absl::StatusOr<HttpServer> HttpServer::start(ListenOptions listening, Handler handler) {
  const std::string& address = listening.address;
  const Credentials& c = listening.credentials;
  const size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0)
    return invalid_input("--http: '{}' is not of the form HOST:PORT", address);
  auto parts = std::make_unique<Parts>();
  parts->handler = std::move(handler);
  parts->access.loopback = is_loopback(address);
  const bool secured = c.tls() || !c.token_file.empty();
  if (!secured && !parts->access.loopback && !listening.insecure)
    return invalid_input(
        "--http {}: other machines can reach this address, so it needs --tls-cert, --tls-key, --tls-ca and "
        "--token-file (or --insecure, where the network itself can be trusted)",
        address);
  if (secured) {
    // That the flags belong together is said by the gRPC side, which has the same.
    RETURN_IF_ERROR(read_credential("--tls-cert", c.cert).status());
    RETURN_IF_ERROR(read_credential("--tls-key", c.key).status());
    parts->access.tokens = listening.tokens;
    parts->cert = c.cert;
    parts->key = c.key;
  }
  if (secured && (mg_init_library(MG_FEATURES_TLS) & MG_FEATURES_TLS) == 0)
    return make_status(absl::StatusCode::kFailedPrecondition, "--http {}: civetweb cannot load libssl.so",
                       address);
  const std::string port = address + (secured ? "s" : "");
  const char* options[] = {"listening_ports",    port.c_str(),      "num_threads",      kThreads,
                           "request_timeout_ms", kRequestTimeoutMs, "max_request_size", kMostRequestBytes,
                           nullptr};
  mg_callbacks callbacks{};
  callbacks.log_message = Parts::log;
  if (secured) callbacks.init_ssl = Parts::init_tls;
  parts->context = mg_start(&callbacks, parts.get(), options);
  if (parts->context == nullptr)
    return invalid_input("--http {}: cannot listen there; is the port in use{}?", address,
                         secured ? ", or are certificate and key no pair" : "");
  mg_set_request_handler(parts->context, "/", Parts::answer, parts.get());
  mg_server_port bound{};
  PENUMBRA_CHECK(mg_get_server_ports(parts->context, 1, &bound) == 1);
  HttpServer server;
  server.url_ = fmt::format("{}://{}:{}", secured ? "https" : "http", address.substr(0, colon), bound.port);
  server.parts_ = std::move(parts);
  return server;
}

}  // namespace penumbra

#include "server/http_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <microhttpd.h>
#include <netdb.h>
#include <spdlog/spdlog.h>

#include <cstdio>
#include <exception>
#include <utility>

#include "proto/status.h"
#include "server/http_access.h"

namespace penumbra {
namespace {

// Every connection has a thread of its own: a viewer that reads or asks slowly holds up nobody else.
constexpr unsigned kMostConnections = 128, kMostOfOneAddress = 32, kIdleSeconds = 15;
constexpr size_t kMostRequestBytes = 32 << 10;  // line and headers
constexpr const char* kTlsVersions = "NORMAL:-VERS-TLS-ALL:+VERS-TLS1.3:+VERS-TLS1.2";

const char* reason(int code) {
  switch (code) {
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 405:
      return "Method Not Allowed";
    default:
      return "Internal Server Error";
  }
}

HttpReply plain(int code) {
  return {code, "text/plain; charset=utf-8", fmt::format("{}\n", reason(code))};
}

std::string_view header(MHD_Connection* connection, const char* name) {
  const char* value = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, name);
  return value == nullptr ? std::string_view() : std::string_view(value);
}

MHD_Result add_variable(void* request, MHD_ValueKind, const char* name, const char* value) {
  static_cast<HttpRequest*>(request)->variables[name] = value == nullptr ? "" : value;
  return MHD_YES;
}

/// Pages load from this server alone, and no other site may show them in a frame.
MHD_Result send(MHD_Connection* connection, const HttpReply& reply) {
  MHD_Response* response = MHD_create_response_from_buffer(
      reply.body.size(), const_cast<char*>(reply.body.data()), MHD_RESPMEM_MUST_COPY);
  if (response == nullptr) return MHD_NO;
  MHD_add_response_header(response, "Content-Type", reply.type.c_str());
  MHD_add_response_header(response, "Cache-Control", "no-store");
  MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
  MHD_add_response_header(response, "Content-Security-Policy",
                          "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'");
  if (reply.code == 401)
    MHD_add_response_header(response, "WWW-Authenticate",
                            "Basic realm=\"Penumbra: the token is the password\"");
  const MHD_Result queued = MHD_queue_response(connection, static_cast<unsigned>(reply.code), response);
  MHD_destroy_response(response);
  return queued;
}

/// The library's own complaints: mostly of peers that hung up, which anybody can make us write.
void log(void*, const char* format, va_list arguments) {
  char message[512];
  std::vsnprintf(message, sizeof message, format, arguments);
  const std::string_view text(message);
  spdlog::debug("http: {}", text.substr(0, text.find_last_not_of('\n') + 1));
}

using Address = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

absl::StatusOr<Address> resolve(const std::string& address) {
  const size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0)
    return invalid_input("--http: '{}' is not of the form HOST:PORT", address);
  std::string host = address.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  addrinfo hints{}, *found = nullptr;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  const int code = getaddrinfo(host.c_str(), address.substr(colon + 1).c_str(), &hints, &found);
  if (code != 0) return invalid_input("--http {}: {}", address, gai_strerror(code));
  return Address(found, freeaddrinfo);
}

/// The port that the daemon is bound to.
int port_of(MHD_Daemon* daemon) {
  sockaddr_storage bound{};
  socklen_t size = sizeof bound;
  const MHD_DaemonInfo* info = MHD_get_daemon_info(daemon, MHD_DAEMON_INFO_LISTEN_FD);
  PENUMBRA_CHECK(info != nullptr &&
                 getsockname(info->listen_fd, reinterpret_cast<sockaddr*>(&bound), &size) == 0);
  return ntohs(bound.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(bound).sin6_port
                                           : reinterpret_cast<const sockaddr_in&>(bound).sin_port);
}

}  // namespace

struct HttpServer::Parts {
  Handler handler;
  HttpAccess access;
  std::string cert, key;  ///< PEM; empty: no TLS
  MHD_Daemon* daemon = nullptr;

  ~Parts() {
    if (daemon != nullptr) MHD_stop_daemon(daemon);
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

  /// Called when the headers are there, then for each piece of a body, then at the end of the request.
  static MHD_Result answer(void* self, MHD_Connection* connection, const char* url, const char* method,
                           const char*, const char*, size_t* body_bytes, void** seen) {
    const Parts& parts = *static_cast<const Parts*>(self);
    if (*seen == nullptr) {
      *seen = self;
      const std::optional<int> refused = refusal(
          parts.access, url, {method, header(connection, "Host"), header(connection, "Authorization")});
      return refused ? send(connection, plain(*refused)) : MHD_YES;
    }
    if (*body_bytes != 0) return MHD_NO;  // who only reads sends none: hang up
    HttpRequest request{url, {}};
    MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, add_variable, &request);
    return send(connection, parts.handle(request));
  }

  bool listen(const addrinfo& address) {
    unsigned flags =
        MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_THREAD_PER_CONNECTION | MHD_USE_POLL | MHD_USE_ERROR_LOG;
    if (address.ai_family == AF_INET6) flags |= MHD_USE_IPv6;
    if (!cert.empty()) flags |= MHD_USE_TLS;
    const MHD_OptionItem tls[] = {{MHD_OPTION_HTTPS_MEM_CERT, 0, cert.data()},
                                  {MHD_OPTION_HTTPS_MEM_KEY, 0, key.data()},
                                  {MHD_OPTION_HTTPS_PRIORITIES, 0, const_cast<char*>(kTlsVersions)},
                                  {MHD_OPTION_END, 0, nullptr}};
    const MHD_OptionItem none[] = {{MHD_OPTION_END, 0, nullptr}};
    daemon = MHD_start_daemon(flags, 0, nullptr, nullptr, answer, this, MHD_OPTION_EXTERNAL_LOGGER, log,
                              nullptr, MHD_OPTION_SOCK_ADDR, address.ai_addr, MHD_OPTION_CONNECTION_LIMIT,
                              kMostConnections, MHD_OPTION_PER_IP_CONNECTION_LIMIT, kMostOfOneAddress,
                              MHD_OPTION_CONNECTION_TIMEOUT, kIdleSeconds, MHD_OPTION_CONNECTION_MEMORY_LIMIT,
                              kMostRequestBytes, MHD_OPTION_ARRAY, cert.empty() ? none : tls, MHD_OPTION_END);
    return daemon != nullptr;
  }
};

HttpServer::HttpServer() = default;
HttpServer::HttpServer(HttpServer&&) noexcept = default;
HttpServer& HttpServer::operator=(HttpServer&&) noexcept = default;
HttpServer::~HttpServer() = default;

absl::StatusOr<HttpServer> HttpServer::start(ListenOptions listening, Handler handler) {
  const std::string& address = listening.address;
  const Credentials& c = listening.credentials;
  ASSIGN_OR_RETURN(const Address where, resolve(address));
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
    ASSIGN_OR_RETURN(parts->cert, read_credential("--tls-cert", c.cert));
    ASSIGN_OR_RETURN(parts->key, read_credential("--tls-key", c.key));
    parts->access.tokens = listening.tokens;
    if (MHD_is_feature_supported(MHD_FEATURE_TLS) != MHD_YES || parts->access.tokens.empty())
      return make_status(absl::StatusCode::kFailedPrecondition,
                         "--http {}: this libmicrohttpd has no TLS, or there is no token", address);
  }
  if (!parts->listen(*where))
    return invalid_input("--http {}: cannot listen there; is the port in use{}?", address,
                         secured ? ", or are certificate and key no pair" : "");
  HttpServer server;
  server.url_ = fmt::format("{}://{}:{}", secured ? "https" : "http", address.substr(0, address.rfind(':')),
                            port_of(parts->daemon));
  server.parts_ = std::move(parts);
  return server;
}

}  // namespace penumbra

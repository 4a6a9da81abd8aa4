#pragma once
// The HTTP side of the server: one address, who may ask, and how replies leave. What is asked for is decided
// elsewhere (http_pages.h).
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/listener.h"

namespace penumbra {

struct HttpRequest {
  std::string path;                              ///< decoded, begins with '/'
  std::map<std::string, std::string> variables;  ///< of the query, decoded
};

struct HttpReply {
  int code = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
};

/// Serves GET and HEAD on an address until it is destroyed.
class HttpServer {
 public:
  /// Called on several threads at once.
  using Handler = std::function<HttpReply(const HttpRequest&)>;

  /// Listens on options.address (port 0: any free one). With TLS flags it is HTTPS, and every path but
  /// /healthz wants a token (http_access.h). InvalidArgument names the flag: a port in use, files that cannot
  /// be read, or an address other machines can reach without TLS and token (unless options.insecure).
  static absl::StatusOr<HttpServer> start(ListenOptions options, Handler handler);
  HttpServer();
  HttpServer(HttpServer&&) noexcept;
  HttpServer& operator=(HttpServer&&) noexcept;
  ~HttpServer();

  /// http(s)://HOST:PORT with the port that was bound.
  const std::string& url() const { return url_; }

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
  std::string url_;
};

}  // namespace penumbra

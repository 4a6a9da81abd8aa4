#include "server/http_access.h"

#include <string>

#include "absl/strings/escaping.h"

namespace penumbra {
namespace {

/// Takes `prefix` away where `text` begins with it.
bool consume(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

bool shows_token(std::string_view authorization, const std::vector<TokenEntry>& tokens) {
  if (consume(authorization, "Bearer ")) return find_token(tokens, authorization) != nullptr;
  std::string decoded;
  if (!consume(authorization, "Basic ") ||
      !absl::Base64Unescape(absl::string_view(authorization.data(), authorization.size()), &decoded))
    return false;
  const size_t colon = decoded.find(':');
  return colon != std::string::npos &&
         find_token(tokens, std::string_view(decoded).substr(colon + 1)) != nullptr;
}

/// "localhost:7401", "127.0.0.1", "[::1]:7401".
bool names_loopback(std::string_view host) {
  const size_t colon = host.rfind(':');
  if (colon != std::string_view::npos && host.find(']', colon) == std::string_view::npos)
    host = host.substr(0, colon);
  return host == "localhost" || host == "127.0.0.1" || host == "[::1]";
}

}  // namespace

std::optional<int> refusal(const HttpAccess& access, std::string_view path, const HttpHeaders& headers) {
  if (headers.method != "GET" && headers.method != "HEAD") return 405;
  if (access.loopback && !names_loopback(headers.host)) return 403;
  if (!access.tokens.empty() && path != "/healthz" && !shows_token(headers.authorization, access.tokens))
    return 401;
  return std::nullopt;
}

}  // namespace penumbra

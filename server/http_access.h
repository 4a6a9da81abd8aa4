#pragma once
// Who may ask. Pure.
#include <optional>
#include <string_view>
#include <vector>

#include "server/token_file.h"

namespace penumbra {

struct HttpAccess {
  /// One of them must be shown, whatever its roles: everything here is reading. Empty: none need be.
  std::vector<TokenEntry> tokens;
  /// The address cannot be reached from elsewhere: then a request must name it as such. A page of another
  /// site whose name was made to point here (DNS rebinding) would ask for its own name.
  bool loopback = false;
};

/// Headers that decide; empty where absent.
struct HttpHeaders {
  std::string_view method, host, authorization;
};

/// Nothing if the request may pass, else the code to refuse it with: 405 (not GET or HEAD), 403 (a foreign
/// host name on loopback), 401 (no or a wrong token). The token comes as `Bearer TOKEN`, or as the password
/// of `Basic` with any user name, which is what browsers can send. `/healthz`
/// needs no token: it says one word.
std::optional<int> refusal(const HttpAccess& access, std::string_view path, const HttpHeaders& headers);

}  // namespace penumbra

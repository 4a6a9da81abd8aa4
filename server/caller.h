#pragma once
// Who makes a call, as the listener's token check has found out.
#include <grpcpp/server_context.h>

#include <string>

namespace penumbra {

inline constexpr char kUserProperty[] = "penumbra-user", kAdminProperty[] = "penumbra-admin";

struct Caller {
  bool known = false;  ///< by a token; else (loopback, --insecure) calls are believed
  bool admin = false;
  std::string user;
  /// Whether the caller may change what belongs to `owner`.
  bool may_touch(const std::string& owner) const { return !known || admin || user == owner; }
};

inline Caller caller_of(const grpc::ServerContextBase& context) {
  Caller caller;
  const auto auth = context.auth_context();
  if (auth == nullptr) return caller;
  for (const grpc::string_ref& value : auth->FindPropertyValues(kUserProperty)) {
    caller.known = true;
    caller.user.assign(value.data(), value.size());
  }
  caller.admin = !auth->FindPropertyValues(kAdminProperty).empty();
  return caller;
}

}  // namespace penumbra

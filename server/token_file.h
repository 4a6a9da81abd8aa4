#pragma once
// Who may call: tokens with a user, roles and quotas.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "server/scheduler.h"

namespace penumbra {

/// What a token allows. An admin may do everything, also to others' jobs.
enum class Role : uint8_t { kSubmit = 1, kWork = 2, kAdmin = 4 };

struct TokenEntry {
  std::array<unsigned char, 32> digest{};  ///< SHA-256 of the token: the token itself is not kept
  std::string user;
  uint8_t roles = 0;  ///< bits of Role
  UserQuota quota;
  double requests_per_second = 0;  ///< 0: no limit
};

/// A file with one token a line, blank lines and lines that begin with # left out:
///   TOKEN USER ROLES [jobs=N] [tasks=N] [rate=N]
/// ROLES is submit, work, admin, or several joined by commas; jobs are unfinished jobs, tasks those in the
/// hands of workers, rate is requests a second. A file with nothing but a token gives it every role.
/// InvalidArgument names flag, file and line, never a token.
absl::StatusOr<std::vector<TokenEntry>> read_token_file(const std::string& path);
absl::StatusOr<std::vector<TokenEntry>> parse_token_file(std::string_view name, std::string_view text);

/// The entry of a token; null if there is none. Takes the same time whichever entry it is and wherever the
/// tokens differ: digests are compared, all of them.
const TokenEntry* find_token(const std::vector<TokenEntry>& entries, std::string_view token);

/// Whether one of the entry's roles allows a method such as "/penumbra.v1.Render/Submit".
bool allows(const TokenEntry& entry, std::string_view method);

}  // namespace penumbra

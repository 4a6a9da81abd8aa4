#include "server/token_file.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>

#include <algorithm>
#include <charconv>
#include <set>
#include <sstream>

#include "proto/channel.h"
#include "proto/status.h"

namespace penumbra {
namespace {

std::array<unsigned char, 32> digest_of(std::string_view token) {
  std::array<unsigned char, 32> out{};
  unsigned int size = 0;
  PENUMBRA_CHECK(EVP_Digest(token.data(), token.size(), out.data(), &size, EVP_sha256(), nullptr) == 1);
  return out;
}

std::optional<Role> role_named(std::string_view name) {
  if (name == "submit") return Role::kSubmit;
  if (name == "work") return Role::kWork;
  if (name == "admin") return Role::kAdmin;
  return std::nullopt;
}

bool parse_roles(const std::string& text, TokenEntry& entry) {
  std::istringstream in(text);
  for (std::string name; std::getline(in, name, ',');) {
    const std::optional<Role> role = role_named(name);
    if (!role) return false;
    entry.roles |= static_cast<uint8_t>(*role);
  }
  return entry.roles != 0;
}

bool parse_limit(std::string_view text, TokenEntry& entry) {
  const size_t equals = text.find('=');
  if (equals == std::string_view::npos) return false;
  const std::string_view name = text.substr(0, equals), value = text.substr(equals + 1);
  uint64_t number = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || end != value.data() + value.size() || number == 0) return false;
  if (name == "jobs") {
    entry.quota.jobs = number;
  } else if (name == "tasks") {
    entry.quota.leases = number;
  } else if (name == "rate") {
    entry.requests_per_second = static_cast<double>(number);
  } else {
    return false;
  }
  return true;
}

/// Why a line is no entry; empty if it is one.
std::string parse_line(const std::vector<std::string>& words, TokenEntry& entry) {
  entry.digest = digest_of(words[0]);
  if (words.size() == 1) {
    entry.roles = static_cast<uint8_t>(Role::kSubmit) | static_cast<uint8_t>(Role::kWork) |
                  static_cast<uint8_t>(Role::kAdmin);
    return {};
  }
  if (words.size() < 3) return "it is not of the form TOKEN USER ROLES [jobs=N] [tasks=N] [rate=N]";
  entry.user = words[1];
  if (!parse_roles(words[2], entry)) return "roles are submit, work and admin, joined by commas";
  for (size_t i = 3; i < words.size(); ++i)
    if (!parse_limit(words[i], entry)) return "limits are jobs=N, tasks=N and rate=N, N above 0";
  return {};
}

bool begins_with(std::string_view method, std::string_view service) {
  return method.substr(0, service.size()) == service;
}

}  // namespace

absl::StatusOr<std::vector<TokenEntry>> parse_token_file(std::string_view name, std::string_view text) {
  std::vector<TokenEntry> entries;
  std::set<std::array<unsigned char, 32>> seen;
  std::istringstream in{std::string(text)};
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    std::istringstream split(line);
    const std::vector<std::string> words{std::istream_iterator<std::string>(split), {}};
    if (words.empty() || words[0][0] == '#') continue;
    TokenEntry entry;
    if (const std::string fault = parse_line(words, entry); !fault.empty())
      return invalid_input("--token-file: {}:{}: {}", name, number, fault);
    if (!seen.insert(entry.digest).second)
      return invalid_input("--token-file: {}:{}: the token stands twice", name, number);
    entries.push_back(std::move(entry));
  }
  if (entries.empty()) return invalid_input("--token-file: {}: holds no token", name);
  return entries;
}

absl::StatusOr<std::vector<TokenEntry>> read_token_file(const std::string& path) {
  ASSIGN_OR_RETURN(const std::string text, read_credential("--token-file", path));
  return parse_token_file(path, text);
}

const TokenEntry* find_token(const std::vector<TokenEntry>& entries, std::string_view token) {
  const std::array<unsigned char, 32> digest = digest_of(token);
  const TokenEntry* found = nullptr;
  for (const TokenEntry& entry : entries)
    if (CRYPTO_memcmp(entry.digest.data(), digest.data(), digest.size()) == 0) found = &entry;
  return found;
}

bool allows(const TokenEntry& entry, std::string_view method) {
  const auto has = [&](Role role) { return (entry.roles & static_cast<uint8_t>(role)) != 0; };
  if (has(Role::kAdmin)) return true;
  if (begins_with(method, "/penumbra.v1.Render/")) return has(Role::kSubmit);
  if (begins_with(method, "/penumbra.v1.Worker/")) return has(Role::kWork);
  if (begins_with(method, "/penumbra.v1.Blobs/")) return has(Role::kSubmit) || has(Role::kWork);
  return begins_with(method, "/grpc.health.v1.Health/");
}

}  // namespace penumbra

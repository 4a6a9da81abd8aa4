#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "proto/status.h"
#include "scenes/bundle.h"
#include "scenes/bundle_names.h"
#include "scenes/diagnostics.h"

namespace penumbra {
namespace {

using nlohmann::json;

// An index is text from a stranger: its limits are far above any scene's and far below any memory's.
constexpr size_t kMostEntries = 1'000'000;
constexpr uint64_t kLargestFile = uint64_t{1} << 40;

bool is_digest(std::string_view text) {
  return text.size() == 64 && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

/// The string at key, or null.
const std::string* string_at(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get_ptr<const std::string*>() : nullptr;
}

absl::StatusOr<BundleEntry> entry_of(const json& item) {
  if (!item.is_object()) return invalid_input("bundle index: an entry is no object");
  const std::string* const name = string_at(item, "name");
  const std::string* const reference = string_at(item, "reference");
  const std::string* const digest = string_at(item, "sha256");
  const auto size = item.find("size");
  if (!name || !reference || !digest || size == item.end() || !size->is_number_unsigned() || item.size() != 4)
    return invalid_input("bundle index: an entry needs name, reference, sha256 and size, and nothing else");
  RETURN_IF_ERROR(check_bundle_name(*name));
  if (!is_digest(*digest)) return invalid_input("bundle index: '{}' has no SHA-256", printable(*name));
  BundleEntry entry{*reference, *name, *digest, size->get<uint64_t>()};
  if (entry.size > kLargestFile) return invalid_input("bundle index: '{}' is too large", printable(*name));
  return entry;
}

}  // namespace

std::string serialize(const BundleIndex& index) {
  json entries = json::array();
  for (const BundleEntry& entry : index.entries)
    entries.push_back({{"name", entry.name},
                       {"reference", entry.reference},
                       {"sha256", entry.digest},
                       {"size", entry.size}});
  // Keys come out sorted and without blanks: the same index is always the same text. Names are UTF-8
  // (check_bundle_name); a reference need not be, it only tells people where a file came from.
  const json document{{"entries", std::move(entries)}, {"main", index.main}, {"schema", 1}};
  return document.dump(-1, ' ', false, json::error_handler_t::replace);
}

absl::StatusOr<BundleIndex> parse_bundle_index(std::string_view text) {
  if (text.size() > kMostIndexBytes) return invalid_input("bundle index: {} bytes are too many", text.size());
  const json document = json::parse(text, nullptr, false);
  if (!document.is_object()) return invalid_input("bundle index: not a JSON object");
  const auto schema = document.find("schema");
  const auto entries = document.find("entries");
  const std::string* const main = string_at(document, "main");
  if (schema == document.end() || *schema != 1 || !main || entries == document.end() || !entries->is_array())
    return invalid_input("bundle index: needs schema 1, main and entries");
  if (entries->size() > kMostEntries)
    return invalid_input("bundle index: {} entries are too many", entries->size());
  BundleIndex index;
  index.main = *main;
  for (const json& item : *entries) {
    ASSIGN_OR_RETURN(BundleEntry entry, entry_of(item));
    if (!index.entries.empty() && entry.name <= index.entries.back().name)
      return invalid_input("bundle index: '{}' is repeated or out of order", printable(entry.name));
    index.entries.push_back(std::move(entry));
  }
  const auto is_main = [&index](const BundleEntry& entry) { return entry.name == index.main; };
  if (std::none_of(index.entries.begin(), index.entries.end(), is_main))
    return invalid_input("bundle index: the main file '{}' is not among the entries", printable(index.main));
  return index;
}

}  // namespace penumbra

#include "scenes/bundle_names.h"

#include <algorithm>
#include <vector>

#include "proto/status.h"
#include "proto/utf8.h"
#include "scenes/diagnostics.h"

namespace penumbra {
namespace {

constexpr size_t kLongestName = 4096;

std::vector<std::string_view> components_of(std::string_view path) {
  std::vector<std::string_view> components;
  for (size_t at = 0; at <= path.size();) {
    const size_t end = std::min(path.find('/', at), path.size());
    components.push_back(path.substr(at, end - at));
    at = end + 1;
  }
  return components;
}

bool is_reserved(std::string_view component) {
  if (component == "in" || component == "root") return true;
  return component.starts_with("up") && component.size() > 2 &&
         std::all_of(component.begin() + 2, component.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::string bundle_name(std::string_view reference) {
  std::string slashes(reference);
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  std::vector<std::string_view> kept;
  int up = 0;
  for (const std::string_view component : components_of(slashes)) {
    if (component.empty() || component == ".") continue;
    if (component != "..")
      kept.push_back(component);
    else if (!kept.empty())
      kept.pop_back();
    else
      ++up;
  }
  std::string name;
  if (slashes.starts_with('/'))
    name = "root";
  else if (up > 0)
    name = fmt::format("up{}", up);
  else if (!kept.empty() && is_reserved(kept.front()))
    name = "in";
  for (const std::string_view component : kept) {
    if (!name.empty()) name += '/';
    name += component;
  }
  return name;
}

absl::Status check_bundle_name(std::string_view name) {
  const auto refuse = [name](std::string_view why) {
    return invalid_input("bundle index: name '{}' {}", printable(name), why);
  };
  if (name.empty()) return refuse("is empty");
  if (name.size() > kLongestName) return refuse("is too long");
  if (name.find('\0') != std::string_view::npos) return refuse("contains a NUL");
  if (name.find('\\') != std::string_view::npos) return refuse("contains a backslash");
  if (!is_utf8(name)) return refuse("is not UTF-8");
  if (name.front() == '/') return refuse("is absolute");
  for (const std::string_view component : components_of(name)) {
    if (component.empty()) return refuse("has an empty component");
    if (component == "." || component == "..") return refuse("leaves the bundle");
  }
  return absl::OkStatus();
}

}  // namespace penumbra

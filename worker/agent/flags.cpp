#include "worker/agent/flags.h"

#include <charconv>
#include <cmath>
#include <initializer_list>

#include "proto/status.h"

namespace penumbra {
namespace {

struct Unit {
  std::string_view suffix;
  double factor;
};

absl::StatusOr<double> parse_amount(std::string_view flag, std::string_view text,
                                    std::initializer_list<Unit> units, std::string_view examples) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc()) {
    const std::string_view suffix = text.substr(static_cast<size_t>(end - text.data()));
    for (const Unit& unit : units)
      if (suffix == unit.suffix && value > 0 && std::isfinite(value)) return value * unit.factor;
  }
  return invalid_input("{}: '{}' is not an amount above 0 such as {}", flag, text, examples);
}

}  // namespace

absl::StatusOr<double> parse_duration_flag(std::string_view flag, std::string_view text) {
  return parse_amount(flag, text, {{"ms", 1e-3}, {"s", 1}, {"m", 60}, {"h", 3600}}, "500ms, 30s, 2m or 1h");
}

absl::StatusOr<uint64_t> parse_bytes_flag(std::string_view flag, std::string_view text) {
  constexpr double k = 1024;
  ASSIGN_OR_RETURN(
      const double bytes,
      parse_amount(flag, text, {{"M", k * k}, {"G", k * k * k}, {"T", k * k * k * k}}, "512M, 8G or 1T"));
  constexpr double kMost = 1e18;  // still a whole number of bytes that fits
  if (bytes < 1 || bytes > kMost) return invalid_input("{}: '{}' is out of range", flag, text);
  return static_cast<uint64_t>(bytes);
}

}  // namespace penumbra

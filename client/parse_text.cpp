#include "client/parse_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "film/film_image.h"
#include "proto/status.h"

namespace penumbra {
namespace {

/// The whole of the text as a number, or nothing.
template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

constexpr std::array<std::pair<std::string_view, SamplerKind>, 3> kSamplers = {
    {{"independent", SamplerKind::kIndependent},
     {"stratified", SamplerKind::kStratified},
     {"sobol", SamplerKind::kSobol}}};

}  // namespace

absl::StatusOr<int64_t> parse_whole(std::string_view flag, std::string_view text, int64_t least,
                                    int64_t most) {
  const auto value = number<int64_t>(text);
  if (!value || *value < least || *value > most)
    return invalid_input("{}: '{}' is not a whole number from {} to {}", flag, text, least, most);
  return *value;
}

absl::StatusOr<uint64_t> parse_seed(std::string_view flag, std::string_view text) {
  const auto value = number<uint64_t>(text);
  if (!value) return invalid_input("{}: '{}' is not a whole number from 0 to 2^64 - 1", flag, text);
  return *value;
}

absl::StatusOr<double> parse_positive(std::string_view flag, std::string_view text) {
  const auto value = number<double>(text);
  if (!value || !std::isfinite(*value) || !(*value > 0))
    return invalid_input("{}: '{}' is not a positive number", flag, text);
  return *value;
}

absl::StatusOr<double> parse_percent(std::string_view flag, std::string_view text) {
  const auto value = text.ends_with('%') ? number<double>(text.substr(0, text.size() - 1)) : std::nullopt;
  if (!value || !std::isfinite(*value) || !(*value > 0))
    return invalid_input("{}: '{}' is not a positive percentage such as 5%", flag, text);
  return *value / 100;
}

absl::StatusOr<double> parse_duration(std::string_view flag, std::string_view text) {
  constexpr std::array<std::pair<std::string_view, double>, 4> kUnits = {
      {{"ms", 1e-3}, {"s", 1.0}, {"m", 60.0}, {"h", 3600.0}}};
  for (const auto& [unit, seconds] : kUnits) {
    if (!text.ends_with(unit)) continue;
    const auto count = number<double>(text.substr(0, text.size() - unit.size()));
    if (!count) continue;  // the "s" of "ms"
    const double duration = *count * seconds;
    if (std::isfinite(duration) && duration > 0) return duration;
    return invalid_input("{}: '{}' is not more than nothing and finite", flag, text);
  }
  return invalid_input("{}: '{}' is not a duration such as 500ms, 30s, 2m", flag, text);
}

absl::StatusOr<Resolution> parse_resolution(std::string_view flag, std::string_view text) {
  const size_t x = text.find('x');
  const auto width = number<int>(text.substr(0, x));
  const auto height = x == std::string_view::npos ? std::nullopt : number<int>(text.substr(x + 1));
  if (!width || !height) return invalid_input("{}: '{}' is not a resolution such as 640x360", flag, text);
  if (*width < 1 || *height < 1 || *width > kMostImageEdge || *height > kMostImageEdge ||
      int64_t{*width} * *height > kMostImagePixels)
    return invalid_input("{}: {} is out of range: 1 to {} pixels a side, at most {} in all", flag, text,
                         kMostImageEdge, kMostImagePixels);
  return Resolution{*width, *height};
}

absl::StatusOr<PixelPlace> parse_pixel(std::string_view flag, std::string_view text) {
  const size_t comma = text.find(',');
  const auto x = number<int>(text.substr(0, comma));
  const auto y = comma == std::string_view::npos ? std::nullopt : number<int>(text.substr(comma + 1));
  if (!x || !y || *x < 0 || *y < 0)
    return invalid_input("{}: '{}' is not a pixel such as 128,134", flag, text);
  return PixelPlace{*x, *y};
}

absl::StatusOr<PixelRect> parse_rect(std::string_view flag, std::string_view text) {
  PixelRect rect;
  std::string_view rest = text;
  bool whole = true;
  for (int* const edge : {&rect.x0, &rect.y0, &rect.x1, &rect.y1}) {
    const size_t comma = rest.find(',');
    const auto value = number<int>(rest.substr(0, comma));
    const bool last = edge == &rect.y1;
    if (!value || last != (comma == std::string_view::npos)) {
      whole = false;
      break;
    }
    *edge = *value;
    if (!last) rest.remove_prefix(comma + 1);
  }
  if (!whole) return invalid_input("{}: '{}' is not X0,Y0,X1,Y1 in pixels", flag, text);
  if (rect.x0 < 0 || rect.y0 < 0 || rect.x1 <= rect.x0 || rect.y1 <= rect.y0 || rect.x1 > kMostImageEdge ||
      rect.y1 > kMostImageEdge)
    return invalid_input("{}: '{}' is empty or out of range (half-open: X0 < X1, Y0 < Y1)", flag, text);
  return rect;
}

absl::StatusOr<Transient> parse_transient(std::string_view flag, std::string_view text) {
  const size_t first = text.find(','), second = first == text.npos ? first : text.find(',', first + 1);
  if (second != text.npos) {
    const auto t0 = number<double>(text.substr(0, first));
    const auto t1 = number<double>(text.substr(first + 1, second - first - 1));
    const auto bins = number<int>(text.substr(second + 1));
    if (t0 && t1 && bins) return Transient{*t0, *t1, *bins};
  }
  return invalid_input("{}: '{}' is not T0,T1,BINS", flag, text);
}

absl::StatusOr<Region> parse_region(std::string_view flag, std::string_view text) {
  const size_t equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0)
    return invalid_input("{}: '{}' is not NAME=X0,Y0,X1,Y1", flag, text);
  Region region;
  region.name = text.substr(0, equals);
  ASSIGN_OR_RETURN(region.rect, parse_rect(flag, text.substr(equals + 1)));
  return region;
}

absl::StatusOr<SamplerKind> parse_sampler(std::string_view flag, std::string_view text) {
  for (const auto& [name, kind] : kSamplers)
    if (name == text) return kind;
  return invalid_input("{}: '{}' is none of independent, stratified, sobol", flag, text);
}

std::string_view name_of(SamplerKind kind) {
  for (const auto& [name, k] : kSamplers)
    if (k == kind) return name;
  PENUMBRA_CHECK(false);
}

}  // namespace penumbra

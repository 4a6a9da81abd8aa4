#pragma once
// Range checks shared by the convert_*.cpp files. Each names the field at fault.
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "proto/convert.h"
#include "proto/status.h"

namespace penumbra {

/// Longest text taken from the wire: paths, warnings, log excerpts.
inline constexpr size_t kMostText = 1 << 16;
/// Of a path: a list of jobs has one of each.
inline constexpr size_t kMostPath = 4096;
/// Of a worker's host or id: its messages begin with them.
inline constexpr size_t kMostIdentity = 1024;
/// Most elements of any list in one message. A 65536² image in 64-pixel tiles has 2^20 tiles.
inline constexpr int kMostElements = 1 << 22;

inline absl::Status check_text(std::string_view field, std::string_view text, size_t most = kMostText) {
  if (text.size() > most) return invalid_input("{}: longer than {} bytes", field, most);
  return absl::OkStatus();
}

inline absl::Status check_count(std::string_view field, int count) {
  if (count > kMostElements) return invalid_input("{}: more than {} elements", field, kMostElements);
  return absl::OkStatus();
}

/// Finite and >= 0.
inline absl::Status check_amount(std::string_view field, double value) {
  if (!(value >= 0) || !std::isfinite(value))
    return invalid_input("{}: {} is not a finite number >= 0", field, value);
  return absl::OkStatus();
}

/// What a worker reports of a task is added up over tasks and multiplied: beyond these bounds sums and
/// products would not be finite, and the server could not say any more what has become of the job. Seconds
/// and work are far below 1e100; so is a relative variance, s² of floats below 1e77 over 1e-2 in below 1e9
/// pixels; sums of its squares are below the square of that.
inline constexpr double kMostReported = 1e100;
inline absl::Status check_reported(std::string_view field, double value, double most = kMostReported) {
  if (!(value >= 0 && value <= most))
    return invalid_input("{}: {} is not a number from 0 to {}", field, value, most);
  return absl::OkStatus();
}

template <class Integer>
absl::Status check_range(std::string_view field, Integer value, Integer least, Integer most) {
  if (value < least || value > most)
    return invalid_input("{}: {} is not in [{}, {}]", field, value, least, most);
  return absl::OkStatus();
}

inline constexpr int64_t kMostPasses = int64_t{1} << 40;

/// Element by element; the first error wins.
template <class Domain, class Repeated>
absl::StatusOr<std::vector<Domain>> list_from_proto(std::string_view field, const Repeated& messages) {
  RETURN_IF_ERROR(check_count(field, messages.size()));
  std::vector<Domain> out;
  out.reserve(messages.size());
  for (const auto& message : messages) {
    ASSIGN_OR_RETURN(Domain value, from_proto(message));
    out.push_back(std::move(value));
  }
  return out;
}

template <class Repeated>
absl::StatusOr<std::vector<std::string>> texts_from_proto(std::string_view field, const Repeated& texts) {
  RETURN_IF_ERROR(check_count(field, texts.size()));
  for (const std::string& text : texts) RETURN_IF_ERROR(check_text(field, text));
  return std::vector<std::string>(texts.begin(), texts.end());
}

template <class Repeated>
absl::StatusOr<std::vector<int64_t>> passes_from_proto(std::string_view field, const Repeated& counts) {
  RETURN_IF_ERROR(check_count(field, counts.size()));
  for (const int64_t count : counts) RETURN_IF_ERROR(check_range<int64_t>(field, count, 1, kMostPasses));
  return std::vector<int64_t>(counts.begin(), counts.end());
}

}  // namespace penumbra

#pragma once
// Words of the command line -> values. Every fault is InvalidArgument and begins with the flag.
#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "proto/job.h"

namespace penumbra {

/// A whole number in [least, most], nothing before or after it.
absl::StatusOr<int64_t> parse_whole(std::string_view flag, std::string_view text, int64_t least,
                                    int64_t most);
absl::StatusOr<uint64_t> parse_seed(std::string_view flag, std::string_view text);
/// A finite number > 0.
absl::StatusOr<double> parse_positive(std::string_view flag, std::string_view text);
/// `5%` -> 0.05; finite, > 0.
absl::StatusOr<double> parse_percent(std::string_view flag, std::string_view text);
/// `500ms`, `30s`, `2m`, `1h` -> seconds, > 0.
absl::StatusOr<double> parse_duration(std::string_view flag, std::string_view text);

struct Resolution {
  int width = 0, height = 0;
};
/// `640x360`: at most kMostImageEdge a side and kMostImagePixels in all.
absl::StatusOr<Resolution> parse_resolution(std::string_view flag, std::string_view text);
struct PixelPlace {
  int x = 0, y = 0;
};
/// `X,Y`, not negative.
absl::StatusOr<PixelPlace> parse_pixel(std::string_view flag, std::string_view text);
/// `X0,Y0,X1,Y1`, half-open, not empty, not negative.
absl::StatusOr<PixelRect> parse_rect(std::string_view flag, std::string_view text);
/// `NAME=X0,Y0,X1,Y1`.
absl::StatusOr<Region> parse_region(std::string_view flag, std::string_view text);
/// `T0,T1,BINS`: two finite numbers and a whole one; whether they make sense is fault_of_bins()'s to say.
absl::StatusOr<Transient> parse_transient(std::string_view flag, std::string_view text);
absl::StatusOr<SamplerKind> parse_sampler(std::string_view flag, std::string_view text);
std::string_view name_of(SamplerKind kind);

}  // namespace penumbra

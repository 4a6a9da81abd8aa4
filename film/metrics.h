#pragma once
// How far an image is from a reference, and how sure that figure is.
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "film/film_image.h"
#include "film/statistics.h"

namespace penumbra {

/// ε of relMSE: keeps black pixels from deciding (design §7).
inline constexpr double kRelMseEpsilon = 1e-2;

/// All means are over pixels and channels of the compared region; I the image, R the reference.
struct ErrorFigures {
  PixelRect region;   ///< what was compared
  double relmse = 0;  ///< mean of (I-R)²/(R²+ε); raw, the floor is not subtracted
  std::optional<ConfidenceInterval> relmse_ci;  ///< 95 %; nothing with fewer than two blocks
  double trimmed_relmse = 0;                    ///< the same without the worst 0.1 % of pixels
  double mse = 0;                               ///< mean of (I-R)²
  /// mean of s²/(R²+ε), s the reference's standard error: what relMSE a perfect image would show.
  /// Nothing for a reference without stderr or variance layers.
  std::optional<double> reference_floor;
};

/// Compares over `region` (of the full image, half-open), by default where the image is. InvalidArgument
/// where the resolutions differ, the region does not lie in both windows, or a value there is not finite
/// (named: which pixel). `epsilon` > 0.
///
/// The interval resamples 16×16 blocks with replacement (a fixed seed: the same images give the same
/// interval). Blocks differ in difficulty as well as in luck, and both enter: it answers for other views
/// of the like as well as for other seeds, and is wide for seeds alone.
absl::StatusOr<ErrorFigures> compare(const FilmImage& image, const FilmImage& reference,
                                     std::optional<PixelRect> region = {}, double epsilon = kRelMseEpsilon);

}  // namespace penumbra

#pragma once
// How far an image is from a reference, and how sure that figure is.
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "film/film_image.h"
#include "film/statistics.h"

namespace penumbra {

/// ε of relMSE: keeps black pixels from deciding (design §7).
inline constexpr double kRelMseEpsilon = 1e-2;

/// Where the error is: relMSE of every block of the region's grid (statistics.h, block_grid).
struct ErrorBlocks {
  int edge = 0;                ///< pixels, a power of two
  std::vector<double> relmse;  ///< row by row
  /// ErrorFigures::variance of every block; empty without it.
  std::vector<double> variance = {};
};

/// All means are over pixels and channels of the compared region; I the image, R the reference.
struct ErrorFigures {
  PixelRect region;   ///< what was compared
  double relmse = 0;  ///< mean of (I-R)²/(R²+ε); raw, the floor is not subtracted
  /// 95 %, of the relMSE that other seeds would show; nothing with fewer than two pixels or without error.
  std::optional<ConfidenceInterval> relmse_ci;
  double trimmed_relmse = 0;  ///< the same without the worst 0.1 % of pixels
  double mse = 0;             ///< mean of (I-R)²
  /// mean of s²/(R²+ε), s the reference's standard error: what relMSE a perfect image would show.
  /// Nothing for a reference without stderr or variance layers.
  std::optional<double> reference_floor;
  /// mean of s²/(R²+ε), s the image's standard error: relMSE of an unbiased image over all seeds, as this
  /// one's own scatter tells. Less noisy than relmse, of which every pixel is one square; blind to bias.
  /// Nothing for an image without a variance layer.
  std::optional<double> variance;
  /// At most 1024, so that two runs can be compared place by place (client/gate).
  ErrorBlocks blocks;
};

/// Compares over `region` (of the full image, half-open), by default where the image is. InvalidArgument
/// where the resolutions differ, the region does not lie in both windows, or a value there is not finite
/// (named: which pixel). `epsilon` > 0.
///
/// The interval is about seeds: what relMSE has the same estimator, with as many passes, on this scene?
/// Pixels share no samples, so their errors e_p are independent, and neighbours are about equally hard: the
/// scatter within cells of 2×2 pixels estimates Var Σ e_p = Σ_cells n s² (a stratified bootstrap of single
/// pixels in closed form). Where difficulty changes within a cell the interval is a little too wide. It is
/// symmetric in log relMSE, with the degrees of freedom that the scatter's own tails leave (estimate.h).
absl::StatusOr<ErrorFigures> compare(const FilmImage& image, const FilmImage& reference,
                                     std::optional<PixelRect> region = {}, double epsilon = kRelMseEpsilon);

}  // namespace penumbra

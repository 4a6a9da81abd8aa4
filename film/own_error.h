#pragma once
// What a run says of its own error when there is no reference.
//
// For an unbiased image I with mean R, the expectation of relMSE is the mean of Var(I)/(R²+ε). Both
// estimates put an estimate of Var(I) above and, for R, the image's mean over 5×5 pixels below (a pixel's
// own value would hide its noise). They see no bias, and nothing that no sample has found.
#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "film/film_image.h"
#include "film/statistics.h"

namespace penumbra {

/// The relMSE that the image would show against a perfect reference, by its own account.
struct OwnError {
  double relmse = 0;
  std::optional<ConfidenceInterval> relmse_ci;  ///< 95 %, from 16×16 blocks
};

/// Mean over pixels and channels of v/(R²+ε), v the variance layer (that of the mean). Nothing without
/// that layer, or where a pixel has fewer than two samples (its variance is unknown).
std::optional<OwnError> own_error(const FilmImage& image);

/// Of an early image from a later one whose samples include the early one's: with k of m passes in both,
/// I_m = (k I_k + (m-k) J)/m and J independent of I_k, so I_k - I_m = (m-k)/m (I_k - J), whose square has
/// the mean ((m-k)/m)² σ²(1/k + 1/(m-k)) = σ²/k · (m-k)/m. Hence Var(I_k) = E (I_k-I_m)² · m/(m-k).
/// Nothing unless 0 < k < m and both images cover the same pixels.
std::optional<OwnError> own_error(const FilmImage& early, int64_t early_passes, const FilmImage& late,
                                  int64_t late_passes);

}  // namespace penumbra

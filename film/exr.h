#pragma once
// OpenEXR files: the product's images out, any renderer's images in.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "film/film_image.h"

namespace penumbra {

/// Header attributes of a written image.
struct ExrHeader {
  std::string mix;         ///< `penumbra:mix`, the label
  double cpu_seconds = 0;  ///< `penumbra:cpu_seconds`, float
  std::string scene;       ///< `penumbra:scene`, absolute path
  uint64_t seed = 0;       ///< `penumbra:seed`, decimal digits (EXR has no 64-bit integer)
  bool partial = false;    ///< `penumbra:partial` = 1, only written for an interrupted run
  /// `penumbra:transient` = T0,T1,BINS, only written for a job with it.
  std::optional<Transient> transient = {};
};

/// Layers R G B, variance.{R,G,B}, samples, cost, those that the image has, 32-bit float, ZIP; the data
/// window is the image's window, the display window the full image. `penumbra:version` is this program's.
/// Written whole or not at all; a full disk is an error that names the path.
/// With bins, one for each of header.transient, the file has a part for each behind the picture's: `bin.000`,
/// …, with R G B and variance and the attributes `penumbra:t0`, `penumbra:t1` (double). The picture's part is
/// as ever, so readers that know of one part see the picture.
absl::Status write_exr(const std::string& path, const FilmImage& image, const ExrHeader& header,
                       std::span<const FilmImage> bins = {});

/// Reads the first part of any flat EXR: R G B (or Y for all three) in half, float or uint, scan lines or
/// tiles, any compression; alpha and foreign layers are ignored. `variance` comes from variance.{R,G,B},
/// else from stderr.{R,G,B} squared; `samples` and `cost` where they are. Pixels are counted from the
/// display window's corner. InvalidArgument (naming the path) for what is not such a file, is truncated
/// or is larger than kMostImageEdge, kMostImagePixels; NotFound if there is none. Values may be
/// non-finite: the reader of the values decides.
absl::StatusOr<FilmImage> read_exr(const std::string& path);

struct ExrBins {
  Transient transient;
  std::vector<FilmImage> images;  ///< one per bin: mean and variance
};
/// The bins that write_exr() has put into a file; NotFound, InvalidArgument as read_exr(), InvalidArgument
/// for a file without bins.
absl::StatusOr<ExrBins> read_exr_bins(const std::string& path);

}  // namespace penumbra

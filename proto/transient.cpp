#include <cmath>
#include <limits>

#include "fmt/format.h"
#include "proto/job.h"

namespace penumbra {

std::string fault_of_bins(const JobSpec& spec) {
  if (!spec.transient) return {};
  const auto& [t0, t1, bins] = *spec.transient;
  if (!(t0 >= 0) || !(t1 > t0) || !std::isfinite(t1))
    return fmt::format("[{},{}) is no range of path lengths", t0, t1);
  // Lengths are sums of single-precision distances: none is beyond the largest, and bins below the least
  // that is held to full precision would sort what has been lost.
  if (t1 > double(std::numeric_limits<float>::max()))
    return fmt::format("no path is as long as {} in single precision", t1);
  if (bins < 1 || bins > kMostBins) return fmt::format("{} bins; 1 to {} are possible", bins, kMostBins);
  if ((t1 - t0) / bins < double(std::numeric_limits<float>::min()))
    return fmt::format("bins of {} are thinner than single precision can tell", (t1 - t0) / bins);
  // Thinner bins would sort the rounding of path lengths.
  if ((t1 - t0) / bins < 2 * double(std::numeric_limits<float>::epsilon()) * t1)
    return fmt::format("bins of {} are thinner than the rounding of path lengths near {}", (t1 - t0) / bins,
                       t1);
  const int64_t mixes = int64_t(spec.mixes.size()), cells = mixes * bins;
  const int64_t tile =
      std::min(spec.tile, spec.crop.width()) * int64_t{std::min(spec.tile, spec.crop.height())};
  if (tile * cells > kMostTileBins)
    return fmt::format(
        "{} bins × {} mixes of a tile of {} pixels are {} values, more than {}; choose smaller tiles "
        "(--tile)",
        bins, mixes, tile, tile * cells, kMostTileBins);
  if (spec.crop.area() * cells > kMostPictureBins)
    return fmt::format("{} bins × {} mixes of {} pixels are {} values, more than {}", bins, mixes,
                       spec.crop.area(), spec.crop.area() * cells, kMostPictureBins);
  if (spec.probe) return "a probe has no bins";
  return {};
}

}  // namespace penumbra

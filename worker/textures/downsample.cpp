#include "worker/textures/downsample.h"

#include <algorithm>

namespace penumbra {
namespace {

/// What one texel of the coarser axis covers of the finer: texels [first, first + 3), with weights that sum
/// to 1. A ratio n / ⌊n/2⌋ is at most 3, and a span of 2 + 1/m texels touches at most 4.
struct Coverage {
  int first = 0, count = 0;
  float weights[4] = {};
};

Coverage coverage(int i, int fine, int coarse) {
  const double scale = static_cast<double>(fine) / coarse;
  const double lo = i * scale, hi = std::min((i + 1) * scale, static_cast<double>(fine));
  Coverage c;
  c.first = static_cast<int>(lo);
  for (int j = c.first; j < hi && c.count < 4; ++j) {
    c.weights[c.count++] =
        static_cast<float>((std::min<double>(j + 1, hi) - std::max<double>(j, lo)) / scale);
  }
  return c;
}

}  // namespace

Texels halved(const Texels& texels) {
  Texels out{std::max(1, texels.width / 2), std::max(1, texels.height / 2), texels.channels, {}};
  const int channels = texels.channels;
  out.values.resize(static_cast<size_t>(out.width) * out.height * channels);
  std::vector<Coverage> columns(out.width);
  for (int x = 0; x < out.width; ++x) columns[x] = coverage(x, texels.width, out.width);
  for (int y = 0; y < out.height; ++y) {
    const Coverage rows = coverage(y, texels.height, out.height);
    for (int x = 0; x < out.width; ++x) {
      float* to = &out.values[(static_cast<size_t>(y) * out.width + x) * channels];
      for (int j = 0; j < rows.count; ++j) {
        for (int i = 0; i < columns[x].count; ++i) {
          const float weight = rows.weights[j] * columns[x].weights[i];
          const size_t at = static_cast<size_t>(rows.first + j) * texels.width + columns[x].first + i;
          for (int k = 0; k < channels; ++k) to[k] += weight * texels.values[at * channels + k];
        }
      }
    }
  }
  return out;
}

}  // namespace penumbra

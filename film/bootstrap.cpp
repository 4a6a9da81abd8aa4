#include "film/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace penumbra {
namespace {

constexpr double kConfidence = 0.95;
constexpr int kResamples = 2000;
constexpr uint64_t kSeed = 0x70656e756d627261;  // "penumbra"

/// SplitMix64 (Steele, Lea & Flood 2014): a stream good enough to draw blocks.
class SplitMix {
 public:
  uint64_t next() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, n), n < 2^32; biased by less than n / 2^32.
  size_t below(size_t n) { return static_cast<size_t>((next() >> 32) * n >> 32); }

 private:
  uint64_t state_ = kSeed;
};

}  // namespace

std::optional<ConfidenceInterval> bootstrap(const std::vector<BlockError>& blocks) {
  if (blocks.size() < 2) return std::nullopt;
  SplitMix random;
  std::vector<double> means;
  means.reserve(kResamples);
  for (int r = 0; r < kResamples; ++r) {
    BlockError total;
    for (size_t i = 0; i < blocks.size(); ++i) {
      const BlockError& drawn = blocks[random.below(blocks.size())];
      total.sum += drawn.sum;
      total.pixels += drawn.pixels;
    }
    means.push_back(total.sum / total.pixels);
  }
  std::sort(means.begin(), means.end());
  const auto at = [&](double p) { return means[static_cast<size_t>(std::lround(p * (kResamples - 1)))]; };
  return ConfidenceInterval{at((1 - kConfidence) / 2), at((1 + kConfidence) / 2)};
}

}  // namespace penumbra

#include "tests/statistical/render/agreement.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "film/statistics.h"

namespace penumbra::test {
namespace {

/// Where light is found by rare samples only, a block may have met none or few, and its own variance says
/// nothing. Rare events of equal size are Poisson: variance = mean × dispersion, with the dispersion that the
/// mix has in other blocks and the mean that all mixes together give for this one. A quarter of it is a floor
/// that blocks with enough events never touch.
void floor_variances(std::vector<std::vector<Block>>& all) {
  for (int c = 0; c < 3; ++c) {
    std::vector<double> mean(all[0].size(), 0);
    for (const std::vector<Block>& mix : all)
      for (size_t k = 0; k < mix.size(); ++k) mean[k] += mix[k].mean[c] / static_cast<double>(all.size());
    for (std::vector<Block>& mix : all) {
      std::vector<double> dispersion;
      for (const Block& b : mix)
        if (b.mean[c] > 0) dispersion.push_back(b.variance[c] / b.mean[c]);
      if (dispersion.empty()) continue;
      std::sort(dispersion.begin(), dispersion.end());
      const double typical = dispersion[dispersion.size() * 3 / 4];
      for (size_t k = 0; k < mix.size(); ++k)
        mix[k].variance[c] = std::max(mix[k].variance[c], typical * mean[k] / 4);
    }
  }
}

/// What is compared: the blocks of all pairs of mixes.
struct Pairs {
  std::vector<double> a, b, variance;
  std::vector<std::string> names;

  void add(const std::vector<FilmImage>& images, const std::vector<std::string>& mixes, const PixelRect& crop,
           const std::string& what) {
    std::vector<std::vector<Block>> all;
    for (const FilmImage& image : images) all.push_back(blocks(image, crop));
    floor_variances(all);
    for (size_t i = 0; i < all.size(); ++i)
      for (size_t j = i + 1; j < all.size(); ++j)
        for (size_t k = 0; k < all[i].size(); ++k)
          for (int c = 0; c < 3; ++c) {
            a.push_back(all[i][k].mean[c]);
            b.push_back(all[j][k].mean[c]);
            variance.push_back(all[i][k].variance[c] + all[j][k].variance[c]);
            names.push_back(what + mixes[i] + " against " + mixes[j] + ", block " + std::to_string(k));
          }
  }
};

}  // namespace

void expect_agreement(const ScenePtr& scene, const std::vector<std::string>& mixes,
                      const AgreementSpec& how) {
  ASSERT_TRUE(scene);
  JobSpec spec = job(how.width, how.height, mixes, how.passes);
  spec.sampler = how.sampler;
  spec.tile = how.tile;
  spec.max_depth = 3;
  if (how.crop.x1 > how.crop.x0) spec.crop = how.crop;
  spec.transient = how.transient;
  const Rendered rendered = render(*scene, spec, how.group);
  for (size_t m = 0; m < mixes.size(); ++m) EXPECT_EQ(rendered.costs[m].non_finite, 0u) << mixes[m];
  Pairs pairs;
  pairs.add(rendered.images, mixes, spec.crop, "");
  for (int b = 0; how.transient && b < how.transient->bins; ++b) {
    std::vector<FilmImage> bin;
    for (const std::vector<FilmImage>& bins : rendered.bins) bin.push_back(bins[size_t(b)]);
    pairs.add(bin, mixes, spec.crop, "bin " + std::to_string(b) + ": ");
  }
  const auto& [a, b, variance, names] = pairs;
  const ZTest z = z_test(a, b, variance, 0.001);
  ASSERT_GT(z.compared, 0);
  EXPECT_TRUE(z.passes()) << z.rejected << " of " << z.compared << " rejected; worst |z| " << z.largest
                          << " (limit " << z.threshold << "): " << names[size_t(z.worst)] << ": "
                          << a[size_t(z.worst)] << " and " << b[size_t(z.worst)];
}

}  // namespace penumbra::test

#include "client/convergence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "proto/status.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

JobSpec picture() {
  JobSpec spec;
  spec.width = 64;
  spec.height = 32;
  spec.crop = {0, 0, 64, 32};
  spec.mixes = {*parse_mix("bsdf:1"), *parse_mix("bsdf:1+line-sa@v:3/smooth=0.2")};
  spec.reference = "/ref.exr";
  spec.regions = {{"left", {0, 0, 8, 8}}};
  return spec;
}

/// A one-pixel image whose variance is that of one estimate over the passes.
FilmImage pixel(double mean, double variance_of_one, int64_t passes) {
  FilmImage image;
  image.width = 64;
  image.height = 32;
  image.window = {3, 4, 4, 5};
  image.rgb.assign(3, static_cast<float>(mean));
  image.variance.assign(3, static_cast<float>(variance_of_one / static_cast<double>(passes)));
  return image;
}

TEST(SquareFactors, AreSquaresOverThreeDecades) {
  EXPECT_EQ(square_factors(1024), (std::vector<int>{1, 4, 9, 16, 36, 64, 121, 256, 529, 1024}));
  EXPECT_EQ(square_factors(4), (std::vector<int>{1, 4}));
}

TEST(ConvergenceJob, AsksForEveryMixAtEveryCountAtOnePixel) {
  const auto job = convergence_job(picture(), 3, 4, {1, 4, 1024}, 100);
  ASSERT_TRUE(job.ok()) << job.status();
  ASSERT_TRUE(job->probe.has_value());
  EXPECT_EQ(job->probe->kind, Probe::Kind::kVariance);
  EXPECT_EQ(job->crop, (PixelRect{3, 4, 4, 5}));
  ASSERT_EQ(job->mixes.size(), 6u);
  EXPECT_EQ(label(job->mixes[4]), "bsdf:4+line-sa@v:12/smooth=0.2");
  EXPECT_EQ(job->plan, (std::vector<int64_t>{1600, 1600, 100, 1600, 1600, 100}));
  EXPECT_TRUE(job->reference.empty());
  EXPECT_TRUE(job->regions.empty());
}

TEST(ConvergenceJob, SaysWhatItCannotDo) {
  EXPECT_THAT(message_of(convergence_job(picture(), 64, 4, {1}, 8).status()),
              HasSubstr("--pixel: 64,4 is not in the image, which is 64x32"));
  JobSpec spec = picture();
  spec.mixes[1].strategies[1].count = 60000;
  EXPECT_THAT(message_of(convergence_job(spec, 3, 4, {1, 4}, 8).status()), HasSubstr("are more than 65536"));
  spec.mixes = {*parse_mix("auto")};
  EXPECT_THAT(message_of(convergence_job(spec, 3, 4, {1}, 8).status()), HasSubstr("--mix: auto"));
  spec.mixes.assign(100, *parse_mix("sa:1"));
  EXPECT_THAT(message_of(convergence_job(spec, 3, 4, {1, 4, 9}, 8).status()), HasSubstr("more than 256"));
}

TEST(Curves, HaveTheSlopeOfTheirVariances) {
  const std::vector<int> factors = square_factors(256);
  const auto job = convergence_job(picture(), 3, 4, factors, 100);
  ASSERT_TRUE(job.ok());
  std::vector<FilmImage> images;
  for (size_t m = 0; m < 2; ++m)
    for (size_t f = 0; f < factors.size(); ++f)
      images.push_back(
          pixel(0.7, 2 * std::pow(factors[f], m == 0 ? -1.5 : -2.25), job->plan[m * factors.size() + f]));
  const auto curves = curves_of(picture(), *job, factors, images);
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_NEAR(curves[0].law->slope, -1.5, 1e-4);
  EXPECT_NEAR(curves[1].law->slope, -2.25, 1e-4);
  EXPECT_EQ(curves[1].points[2].samples, 36) << "all strategies of the mix together";
  EXPECT_NEAR(curves[0].points[0].mean, 0.7, 1e-6);
  EXPECT_NEAR(curves[0].points[0].variance, 2, 1e-5);
  EXPECT_THAT(convergence_text(curves), HasSubstr("-2.25"));
  const Json json = convergence_json(curves);
  EXPECT_EQ(json[1]["mix"], "bsdf:1+line-sa@v:3/smooth=0.2");
  EXPECT_NEAR(json[0]["slope"].get<double>(), -1.5, 1e-4);
  EXPECT_EQ(json[0]["points"].size(), factors.size());
  const std::string svg = convergence_svg(curves, "a < b");
  EXPECT_THAT(svg, HasSubstr("a &lt; b"));
  EXPECT_THAT(svg, HasSubstr("slope -2.25"));
}

TEST(Curves, WithoutVarianceThereIsNoSlope) {
  const std::vector<int> factors = {1, 4, 9};
  JobSpec one = picture();
  one.mixes.resize(1);
  const auto job = convergence_job(one, 3, 4, factors, 100);
  const auto curves = curves_of(one, *job, factors, std::vector<FilmImage>(3, pixel(1, 0, 100)));
  EXPECT_FALSE(curves[0].law.has_value());
  EXPECT_THAT(convergence_text(curves), HasSubstr("no variance"));
  EXPECT_TRUE(convergence_json(curves)[0]["slope"].is_null());
  EXPECT_THAT(convergence_svg(curves, "x"), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace penumbra

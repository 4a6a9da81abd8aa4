// Pictures of media against numbers that share no code with them: exp(-τ) behind a slab, sums over a fine
// grid for single scattering, a furnace.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/support/render.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

/// Mean and standard error per channel over all pixels, which a narrow camera makes all alike.
struct Mean {
  double value[3] = {0, 0, 0}, error[3] = {0, 0, 0};
};
Mean mean_of(const FilmImage& image) {
  Mean m;
  const double n = double(image.pixels());
  for (size_t i = 0; i < image.rgb.size(); ++i) {
    m.value[i % 3] += image.rgb[i] / n;
    m.error[i % 3] += image.variance[i] / (n * n);
  }
  for (double& e : m.error) e = std::sqrt(e);
  return m;
}

/// Looks along +z from the origin, all pixels within 1e-4 degrees.
std::string narrow_scene(const std::string& medium, const std::string& world) {
  return "MakeNamedMedium \"m\" \"string type\" " + medium +
         "\nMediumInterface \"\" \"m\"\nLookAt 0 0 0  0 0 1  0 1 0\nCamera \"perspective\" \"float fov\" "
         "1e-4\n"
         "PixelFilter \"box\"\nWorldBegin\n" +
         world;
}

/// `precision`: of the mean, at most; `grid`: of the reference and of single precision; both relative.
void expect_mean(const std::string& text, const std::vector<std::string>& mixes, int64_t passes,
                 const double (&reference)[3], double precision, double grid = 1e-5) {
  const ScenePtr scene = test::load_text(text);
  ASSERT_TRUE(scene);
  const JobSpec spec = test::job(16, 16, mixes, passes);
  const test::Rendered rendered = test::render(*scene, spec);
  for (size_t m = 0; m < mixes.size(); ++m) {
    const Mean mean = mean_of(rendered.images[m]);
    EXPECT_EQ(rendered.costs[m].non_finite, 0u) << mixes[m];
    for (int c = 0; c < 3; ++c) {
      EXPECT_LE(std::abs(mean.value[c] - reference[c]), 4.5 * mean.error[c] + grid * reference[c])
          << mixes[m] << " channel " << c << ": " << mean.value[c] << " ± " << mean.error[c] << ", not "
          << reference[c];
      EXPECT_LE(mean.error[c], precision * reference[c]) << mixes[m];
    }
  }
}

const std::vector<std::string> kMixes = {"bsdf:2+sa:2",
                                         "area:2",
                                         "sa:2",
                                         "visible-area:2",
                                         "line-area@0:1",
                                         "line-area@37:1",
                                         "line-sa@u:1",
                                         "line-sa@v:1",
                                         "bsdf:1+line-sa@v:1",
                                         "area:1+line-sa@u:1/power",
                                         "sa:1+line-area@90:1/free",
                                         "line-analytic@0:1",
                                         "line-area@0:1+sa:1/smooth=auto",
                                         "sa:2/medium=line"};

TEST(Media, ASlabLetsThroughExpOfItsDepth) {
  for (const double depth : {1e-8, 1e-3, 1.0, 20.0, 1e4}) {
    char text[300];
    // The slab is the whole way of 4 to the light.
    std::snprintf(text, sizeof text, "\"homogeneous\" \"rgb sigma_a\" [%.9g %.9g 0] \"rgb sigma_s\" [0 0 0]",
                  depth / 4, depth / 8);
    const std::string light =
        "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1]\nMaterial \"matte\"\n"
        "Shape \"quad\" \"point o\" [-1 -1 4] \"vector u\" [0 2 0] \"vector v\" [2 0 0]\n";
    const double reference[3] = {std::exp(-depth), std::exp(-depth / 2), 1};
    expect_mean(narrow_scene(text, light), {"sa:1"}, 1, reference, 0);
  }
}

/// Henyey & Greenstein as it is printed; cosine of the deflection.
double printed_phase(double g, double cosine) {
  return (1 - g * g) / (4 * kPi * std::pow(1 + g * g - 2 * g * cosine, 1.5));
}

/// ∫ dt over [0,end] of what reaches (0,0,t) from `l` with the given strength per squared distance, scattered
/// to the origin: a sum over `steps` midpoints, spaced as t = s²·end.
double scattered_from(const Vec3d& l, double sigma_t, double sigma_s, double g, double end, int steps,
                      const std::function<double(const Vec3d&)>& strength) {
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double s = (i + 0.5) / steps, t = s * s * end, dt = 2 * s * end / steps;
    const Vec3d x(0, 0, t);
    const double r = (x - l).length();
    const double cosine = -(x - l).z / r;
    sum += dt * sigma_s * std::exp(-sigma_t * (t + r)) * printed_phase(g, cosine) * strength(x) / (r * r);
  }
  return sum;
}

TEST(Media, APointLightScatteredOnce) {
  const double sigma_a[3] = {0.1, 0, 0.3}, sigma_s[3] = {0.2, 0.5, 1}, g = 0.4;
  const std::string medium =
      "\"homogeneous\" \"rgb sigma_a\" [0.1 0 0.3] \"rgb sigma_s\" [0.2 0.5 1] \"float g\" 0.4";
  double reference[3];
  for (int c = 0; c < 3; ++c)
    reference[c] = scattered_from(Vec3d(0.3, 0.4, 2), sigma_a[c] + sigma_s[c], sigma_s[c], g, 80, 400000,
                                  [](const Vec3d&) { return 5.0; });
  expect_mean(narrow_scene(medium, "LightSource \"point\" \"point from\" [0.3 0.4 2] \"rgb I\" [5 5 5]\n"),
              {"sa:1", "sa:4/balance/medium=line"}, 64, reference, 0.01);
}

/// The quad light [-0.5,0.5] × {2} × [2,3] that looks down, with a screen below a part of it.
double from_quad(double sigma_t, double sigma_s, double g, bool screen) {
  constexpr int kSide = 40, kSteps = 3000;
  double sum = 0;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vec3d l(-0.5 + (i + 0.5) / kSide, 2, 2 + (j + 0.5) / kSide);
      sum += scattered_from(l, sigma_t, sigma_s, g, 60, kSteps, [&](const Vec3d& x) {
        const double share = 0.5;  // the screen at y = 1 is half way between the ray and the light
        const Vec3d at = x + (l - x) * share;
        if (screen && at.x > -0.2 && at.x < 3 && at.z > 0.5 && at.z < 2.2) return 0.0;
        return 7 * 2 / (l - x).length();  // radiance × cosine at the light
      });
    }
  return sum / (kSide * kSide);
}

TEST(Media, AQuadLightScatteredOnceByEveryStrategy) {
  const std::string medium =
      "\"homogeneous\" \"rgb sigma_a\" [0.1 0 0.3] \"rgb sigma_s\" [0.2 0.5 0.4] \"float g\" -0.3";
  const std::string light =
      "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [7 7 7]\nMaterial \"matte\"\n"
      "Shape \"quad\" \"point o\" [-0.5 2 2] \"vector u\" [1 0 0] \"vector v\" [0 0 1] AttributeEnd\n";
  const std::string screen =
      "Material \"matte\" \"rgb Kd\" [0 0 0]\nShape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] "
      "\"point P\" [-0.2 1 0.5  3 1 0.5  3 1 2.2  -0.2 1 2.2]\n";
  for (const bool screened : {false, true}) {
    double reference[3];
    const double sigma_a[3] = {0.1, 0, 0.3}, sigma_s[3] = {0.2, 0.5, 0.4};
    for (int c = 0; c < 3; ++c) reference[c] = from_quad(sigma_a[c] + sigma_s[c], sigma_s[c], -0.3, screened);
    expect_mean(narrow_scene(medium, light + (screened ? screen : "")), kMixes, 128, reference, 0.02, 1e-3);
  }
}

/// A ball of pure scatterers of optical radius τ under a sky of radiance 1, seen through its middle: what is
/// lost to the ray, 1 - e^-2τ, comes back but for what is scattered a second time. The light that reaches a
/// point at distance q from the middle is a mean over directions, by a sum.
double furnace(double tau) {
  constexpr int kSteps = 4000, kDirections = 4000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double t = 2 * (i + 0.5) / kSteps, q = std::abs(t - 1);
    double mean = 0;
    for (int k = 0; k < kDirections; ++k) {
      const double mu = -1 + 2 * (k + 0.5) / kDirections;
      mean += std::exp(-tau * (-q * mu + std::sqrt(1 - q * q * (1 - mu * mu)))) / kDirections;
    }
    sum += tau * std::exp(-tau * t) * mean * 2 / kSteps;
  }
  return std::exp(-2 * tau) + sum;
}

TEST(Media, FurnaceOfABallOfScatterers) {
  for (const double tau : {1e-8, 1e-3, 0.5, 3.0}) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "\"homogeneous\" \"rgb sigma_a\" [0 0 0] \"rgb sigma_s\" [%.9g %.9g %.9g]", tau, tau, tau);
    const std::string world =
        "LightSource \"infinite\" \"rgb L\" [1 1 1]\nAttributeBegin MediumInterface \"m\" \"\" Material "
        "\"none\"\n"
        "Translate 0 0 3 Shape \"sphere\" AttributeEnd\n";
    std::string scene = narrow_scene(text, world);
    scene.replace(scene.find("MediumInterface \"\" \"m\""), 22, "");
    const double value = furnace(tau);
    const double reference[3] = {value, value, value};
    expect_mean(scene, {"bsdf:2", "sa:2", "bsdf:1+line-sa@u:1", "sa:2/medium=line"}, 64, reference, 0.01,
                3e-4);
    if (tau <= 1e-3) {
      EXPECT_NEAR(value, 1, 4 * tau * tau + 1e-12);
    }
  }
}

}  // namespace
}  // namespace penumbra

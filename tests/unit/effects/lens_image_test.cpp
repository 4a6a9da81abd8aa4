// Pictures through a lens against closed forms: the circle of confusion of a small emitter, sharpness in
// focus, the limit of a pinhole, and no value that is not finite.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/render.h"
#include "worker/effects/lens.h"
#include "worker/render/light_pixels.h"
#include "worker/render/scene.h"

namespace penumbra {
namespace {

constexpr int kEdge = 33;  // the emitter stands in the middle of a pixel
constexpr double kL = 200;

/// Looks along +z with a field of view of 90 degrees: at depth 1 a pixel is 2/33 wide. The emitter is a
/// square of side `side` on the axis at `depth`.
std::string scene(double radius, double focus, double depth, double side, const std::string& more = "") {
  return fmt::format(
      "Camera \"perspective\" \"float fov\" 90 \"float lensradius\" {} \"float focaldistance\" {}\n"
      "PixelFilter \"box\" \"float xwidth\" 0.5 \"float ywidth\" 0.5\nWorldBegin\n{}"
      "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 200 200 200 ] \"bool twosided\" \"true\"\n"
      "Material \"matte\" \"rgb Kd\" [ 0 0 0 ]\n"
      "Shape \"quad\" \"point o\" [ {} {} {} ] \"vector u\" [ {} 0 0 ] \"vector v\" [ 0 {} 0 "
      "]\nAttributeEnd\n",
      radius, focus, more, -side / 2, -side / 2, depth, side, side);
}

FilmImage picture(const std::string& text, const char* mix, int64_t passes, int edge = kEdge,
                  int64_t group = 1) {
  const ScenePtr loaded = test::load_text(text);
  const test::Rendered rendered = test::render(*loaded, test::job(edge, edge, {mix}, passes), group);
  EXPECT_EQ(rendered.costs[0].non_finite, 0u);
  return rendered.images[0];
}

struct Blur {
  const char* mix;
  double depth;
};
class LensBlur : public ::testing::TestWithParam<Blur> {};

/// The emitter is seen through a share side²/(π c²) (at depth 1: its own area over the circle's) of the lens
/// in all pixels inside its circle of confusion c = R |1/f − 1/z|, and nowhere outside.
TEST_P(LensBlur, ASmallEmitterIsADiskOfItsCircleOfConfusion) {
  const double radius = 0.9, focus = 2, depth = GetParam().depth, side = 0.06 * depth;
  const double circle = radius * std::abs(1 / focus - 1 / depth), half = 0.03, pixel = 2.0 / kEdge;
  const double expected = kL * (0.06 * 0.06) / (std::numbers::pi * circle * circle);
  const FilmImage image = picture(scene(radius, focus, depth, side), GetParam().mix, 64);
  double sum = 0, variance = 0;
  int inside = 0;
  for (int y = 0; y < kEdge; ++y)
    for (int x = 0; x < kEdge; ++x) {
      const double to = std::hypot(std::abs(x - 16) + 0.5, std::abs(y - 16) + 0.5) * pixel;
      const double from =
          std::hypot(std::max(std::abs(x - 16) - 0.5, 0.), std::max(std::abs(y - 16) - 0.5, 0.)) * pixel;
      const size_t at = size_t(y * kEdge + x) * 3;
      if (from - half * std::numbers::sqrt2 > circle) {
        EXPECT_EQ(image.rgb[at], 0) << x << ' ' << y;
      }
      if (to + half * std::numbers::sqrt2 >= circle) continue;
      ++inside;
      sum += double(image.rgb[at]);
      variance += double(image.variance[at]);
    }
  ASSERT_GT(inside, 20);
  const double error = std::sqrt(variance) / inside;
  EXPECT_LT(error, 0.06 * expected);
  EXPECT_NEAR(sum / inside, expected, 4.5 * error);
}

INSTANTIATE_TEST_SUITE_P(Lens, LensBlur,
                         ::testing::Values(Blur{"sa:1", 1.0}, Blur{"sa:1", 20.0}, Blur{"sa:1/lens=line", 1.0},
                                           Blur{"sa:1/lens=line", 20.0}));

TEST(LensImage, WhatIsInFocusIsSharp) {
  for (const char* mix : {"sa:1", "sa:1/lens=line"}) {
    // At depth 2 the emitter covers exactly the 5 × 5 pixels in the middle.
    const FilmImage image = picture(scene(0.9, 2, 2, 5 * 4.0 / kEdge), mix, 4);
    for (int y = 0; y < kEdge; ++y)
      for (int x = 0; x < kEdge; ++x) {
        const int from_centre = std::max(std::abs(x - 16), std::abs(y - 16));
        const float seen = image.rgb[size_t(y * kEdge + x) * 3];
        if (from_centre < 2) {
          EXPECT_FLOAT_EQ(seen, float(kL)) << x << ' ' << y;
        } else if (from_centre > 3) {
          EXPECT_EQ(seen, 0) << x << ' ' << y;
        }
      }
  }
}

const char* const kRoom =
    "Material \"matte\"\nShape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point P\" [ -3 -1 0.5  "
    "-3 -1 9  3 -1 "
    "9  3 -1 0.5 ]\nShape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ] \"point P\" [ -2 -1 4  2 -1 4 "
    " 2 3 4  -2 3 4 ]\n"
    "AttributeBegin Translate 0.4 -0.5 2.5 Shape \"sphere\" \"float radius\" 0.5 AttributeEnd\n";

TEST(LensImage, ALensOfNoSizeIsAPinhole) {
  const FilmImage pinhole = picture(scene(0, 3, 3, 0.4, kRoom), "sa:2", 16);
  const FilmImage points = picture(scene(1e-8, 3, 3, 0.4, kRoom), "sa:2", 16);
  const FilmImage lines = picture(scene(1e-8, 3, 3, 0.4, kRoom), "sa:2/lens=line", 16);
  double sum = 0, apart = 0, line_sum = 0;
  for (size_t i = 0; i < pinhole.rgb.size(); ++i) {
    sum += double(pinhole.rgb[i]);
    apart += std::abs(double(points.rgb[i]) - double(pinhole.rgb[i]));
    line_sum += double(lines.rgb[i]);
  }
  // The same camera and light samples: only rays that graze an edge may part.
  EXPECT_LT(apart, 1e-3 * sum);
  // Lines look at the emission from other places of the film.
  EXPECT_NEAR(line_sum, sum, 0.03 * sum);
}

TEST(LensImage, TinyAndHugeLensesAndAFocusInASurfaceStayFinite) {
  for (const double radius : {1e-8, 1e-3, 3.0, 10.0})
    for (const double focus : {1e-4, 2.5, 4.0, 1e6})
      for (const char* mix : {"bsdf:1+sa:1", "bsdf:1+line-sa@u:1/balance/lens=line"}) {
        double sum = 0;
        for (const float value : picture(scene(radius, focus, 3.5, 0.4, kRoom), mix, 2, 17).rgb)
          sum += double(value);
        if (focus < 1) continue;  // from a wide lens such rays leave the room in the lens' own plane
        EXPECT_GT(sum, 0) << radius << ' ' << focus << ' ' << mix;
      }
}

/// What `light_pixels` leaves out sees no light: the emission of the others has rays of its own.
TEST(LensImage, LightPixelsReachAsFarAsTheBlur) {
  for (const double depth : {0.8, 2.0, 30.0}) {
    const ScenePtr loaded = test::load_text(scene(0.5, 2, depth, 0.05 * depth));
    const Camera camera = Camera::build(loaded->description, kEdge, kEdge).value();
    const auto marks = light_pixels(*loaded, camera, {0, 0, kEdge, kEdge});
    const double reach = 0.5 * std::abs(0.5 - 1 / depth) + 0.025;
    for (int y = 0; y < kEdge; ++y)
      for (int x = 0; x < kEdge; ++x) {
        const double across = std::abs(x - 16), up = std::abs(y - 16), pixel = 2.0 / kEdge;
        const bool mark = marks[size_t(y * kEdge + x)] != 0;
        if (std::hypot(std::max(across - 0.5, 0.), std::max(up - 0.5, 0.)) * pixel < reach) {
          EXPECT_TRUE(mark) << x << ' ' << y;
        } else if ((std::max(across, up) - 1.5) * pixel > reach) {
          EXPECT_FALSE(mark) << x << ' ' << y;
        }
      }
  }
}

}  // namespace
}  // namespace penumbra

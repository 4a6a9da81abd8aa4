// Motion blur against pictures of the same scene standing still at many times, each written as text by this
// test, and against closed forms. Nothing of the product's interpolation is used here.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

/// A placement that goes evenly from t = 0 to t = 1, as pbrt text has it.
struct Path {
  double from[3], to[3];
  double degrees = 0, turn = 0;  ///< at t = 0, and by how much until t = 1; about the axis
  double axis[3] = {0, 0, 1};
  double scale[3] = {1, 1, 1}, scaled[3] = {1, 1, 1};

  std::string at(double t) const {
    const auto mix = [t](double a, double b) { return a + t * (b - a); };
    return fmt::format("Translate {} {} {} Rotate {} {} {} {} Scale {} {} {}\n", mix(from[0], to[0]),
                       mix(from[1], to[1]), mix(from[2], to[2]), degrees + t * turn, axis[0], axis[1],
                       axis[2], mix(scale[0], scaled[0]), mix(scale[1], scaled[1]), mix(scale[2], scaled[2]));
  }
  std::string moving() const {
    return "ActiveTransform StartTime " + at(0) + "ActiveTransform EndTime " + at(1) +
           "ActiveTransform All\n";
  }
};
/// Writes a placement: moving, or at one time.
using Placer = std::function<std::string(const Path&)>;
using SceneText = std::function<std::string(const Placer&)>;

struct Pixels {
  std::vector<double> mean, variance;
};

/// Blocks of 4 × 4 pixels.
Pixels blocks_of(const std::vector<float>& rgb, const std::vector<float>* variance, int width, int height) {
  const int across = width / 4, down = height / 4;
  Pixels out;
  out.mean.assign(size_t(across * down) * 3, 0);
  out.variance.assign(out.mean.size(), 0);
  for (int y = 0; y < 4 * down; ++y)
    for (int x = 0; x < 4 * across; ++x)
      for (int c = 0; c < 3; ++c) {
        const size_t block = size_t((y / 4) * across + x / 4) * 3 + size_t(c),
                     pixel = size_t(y * width + x) * 3 + size_t(c);
        out.mean[block] += double(rgb[pixel]) / 16;
        if (variance) out.variance[block] += double((*variance)[pixel]) / 256;
      }
  return out;
}

constexpr int kWidth = 32, kHeight = 24;

/// The scene at stratified times of [0,1], `repeats` times anew: the mean, and its variance from the repeats.
Pixels standing(const SceneText& scene, int repeats, int times, double open, double close, uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Pixels> all;
  for (int r = 0; r < repeats; ++r) {
    std::vector<float> sum(size_t(kWidth * kHeight) * 3, 0);
    for (int k = 0; k < times; ++k) {
      const double when = std::clamp(open + (close - open) * (k + uniform(random)) / times, 0.0, 1.0);
      const ScenePtr still = test::load_text(scene([&](const Path& path) { return path.at(when); }));
      JobSpec job = test::job(kWidth, kHeight, {"sa:1"}, 2);
      job.seed = random();
      const test::Rendered picture = test::render(*still, job);
      for (size_t i = 0; i < sum.size(); ++i) sum[i] += picture.images[0].rgb[i] / float(times);
    }
    all.push_back(blocks_of(sum, nullptr, kWidth, kHeight));
  }
  Pixels out{std::vector<double>(all[0].mean.size(), 0), std::vector<double>(all[0].mean.size(), 0)};
  for (size_t i = 0; i < out.mean.size(); ++i) {
    for (const Pixels& one : all) out.mean[i] += one.mean[i] / repeats;
    for (const Pixels& one : all)
      out.variance[i] +=
          (one.mean[i] - out.mean[i]) * (one.mean[i] - out.mean[i]) / (repeats * (repeats - 1));
  }
  return out;
}

/// Blocks whose difference is far beyond their errors: with 16 repeats the quotient has Student's
/// distribution of some 15 degrees, of which 7 is passed once in 4e5.
void expect_same(const Pixels& a, const Pixels& b, const std::string& what) {
  double squares = 0;
  int counted = 0;
  for (size_t i = 0; i < a.mean.size(); ++i) {
    const double size = std::max(std::abs(a.mean[i]), std::abs(b.mean[i]));
    const double difference = a.mean[i] - b.mean[i];
    const double sigma = std::sqrt(a.variance[i] + b.variance[i]) + 1e-6 * size;
    if (!(sigma > 0)) continue;
    EXPECT_LT(std::abs(difference), 7 * sigma)
        << what << " block " << i / 3 << ": " << a.mean[i] << " and " << b.mean[i];
    squares += difference * difference / (sigma * sigma);
    ++counted;
  }
  // Student's square has the mean 15/13; of some hundreds of blocks the mean is within a third of it.
  EXPECT_LT(squares / counted, 1.6) << what;
}

void expect_as_standing(const SceneText& scene, const std::vector<std::string>& mixes, double open = 0,
                        double close = 1) {
  const Pixels reference = standing(scene, 16, 12, open, close, 1);
  const ScenePtr moving = test::load_text(scene([](const Path& path) { return path.moving(); }));
  ASSERT_TRUE(moving);
  const test::Rendered pictures = test::render(*moving, test::job(kWidth, kHeight, mixes, 96));
  for (size_t m = 0; m < mixes.size(); ++m) {
    EXPECT_EQ(pictures.costs[m].non_finite, 0u) << mixes[m];
    expect_same(blocks_of(pictures.images[m].rgb, &pictures.images[m].variance, kWidth, kHeight), reference,
                mixes[m]);
  }
}

const std::vector<std::string> kMixes = {"sa:1",
                                         "bsdf:1+sa:1",
                                         "line-sa@u:1",
                                         "bsdf:1+line-sa@v:1",
                                         "visible-area:1",
                                         "area:1+line-area@45:1/free",
                                         "sa:1/balance/motion=line",
                                         "line-sa@u:1/balance/motion=line"};

std::string room(const std::string& camera, const std::string& movers) {
  return camera + R"(PixelFilter "box" "float xwidth" 0.5 "float ywidth" 0.5
WorldBegin
AttributeBegin AreaLightSource "diffuse" "rgb L" [9 8 7] Material "matte" "rgb Kd" [0 0 0]
Shape "quad" "point o" [-0.8 3 -0.8] "vector u" [1.6 0 0] "vector v" [0 0 1.6] AttributeEnd
Material "matte" "rgb Kd" [0.6 0.5 0.4]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point P" [-4 0 -4  -4 0 4  4 0 4  4 0 -4]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point P" [-0.9 0 1.5  0.6 0 1.5  0.6 0.9 1.5  -0.9 0.9 1.5]
)" + movers;
}
const std::string kLook = "LookAt 0 1.4 -4.5  0 0.7 0  0 1 0\n";
std::string camera(const std::string& more = "") {
  return kLook + "Camera \"perspective\" \"float fov\" 42 " + more + "\n";
}

const char* const kPlate =
    "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point P\" [-0.5 0 -0.3  0.5 0 -0.3  0.5 0 "
    "0.3  -0.5 0 0.3]\n";
const char* const kSliver =
    "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point P\" [-1 -0.01 0  1 -0.01 0  1 0.01 0  "
    "-1 0.01 0]\n";

TEST(Motion, FlyingTurningAndGrowing) {
  const Path flies{{-1.2, 0.8, -0.3}, {0.9, 1.3, 0.4}},
      turns{{0.4, 1.9, 0}, {0.4, 1.9, 0}, 15, 140, {0.3, 1, 0.2}};
  const Path grows{{1.2, 0.35, 0}, {1.2, 0.5, 0}, 10, 70, {0, 1, 0}, {1, 0.5, 1}, {0.6, 1.4, 1.2}};
  expect_as_standing(
      [&](const Placer& placed) {
        return room(
            camera(),
            "AttributeBegin " + placed(flies) + "Shape \"sphere\" \"float radius\" 0.35 AttributeEnd\n" +
                "AttributeBegin " + placed(turns) + kPlate + kSliver + "AttributeEnd\n" +
                "ObjectBegin \"o\" Material \"plastic\" Shape \"sphere\" \"float radius\" 0.3 ObjectEnd\n" +
                "AttributeBegin " + placed(grows) + "ObjectInstance \"o\" AttributeEnd\n");
      },
      kMixes);
}

const std::vector<std::string> kLightMixes = {"bsdf:3",
                                              "area:2",
                                              "sa:1",
                                              "bsdf:1+line-sa@v:1",
                                              "visible-area:1",
                                              "line-area@30:1+sa:1/power",
                                              "line-analytic@60:1",
                                              "sa:1/balance/motion=line"};
std::string lit(const std::string& shape, const char* radiance, const char* more = "") {
  return fmt::format(
      "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [{}] {} Material \"matte\" \"rgb Kd\" "
      "[0 0 0] {} AttributeEnd\n",
      radiance, more, shape);
}

/// Looks down at the floor: no light above y = 1.2 is in view. What passes the film for a short while is a
/// rare event there, of which neither side's variance knows.
const std::string kDown = "LookAt 0 1.2 -3.2  0 0.1 0.3  0 1 0\nCamera \"perspective\" \"float fov\" 24\n";

/// Lights of every shape that fly, turn, grow and are mirrored, and what stands and moves in their way.
TEST(Motion, LightsThatMove) {
  const Path turns{{-0.9, 1.7, 0.3}, {-0.3, 1.9, 0.1}, -30, 80, {0.2, 0.1, 1}, {-1, 1, 1}, {-0.6, 1.3, 1}};
  const Path grows{{1.1, 1.6, 0.4}, {0.9, 1.9, -0.2}, 0, 20, {1, 0, 0}, {0.6, 0.6, 0.6}, {1.4, 1.4, 1.4}};
  const Path falls{{0.1, 2.4, 0.6}, {0.3, 1.7, 0.9}, 100, 60, {1, 0.2, 0}};
  const Path flies{{-1.5, 1, -0.6}, {1.2, 0.9, 0.3}};
  const std::string quad =
      "Shape \"quad\" \"point o\" [-0.3 0 -0.2] \"vector u\" [0.6 0 0] \"vector v\" [0 0 0.4]";
  expect_as_standing(
      [&](const Placer& placed) {
        return room(kDown, lit(placed(turns) + quad, "14 6 2", "\"bool twosided\" true") +
                               lit(placed(grows) + "Shape \"sphere\" \"float radius\" 0.2", "4 7 3") +
                               lit(placed(falls) + "Shape \"disk\" \"float radius\" 0.3", "2 4 12") +
                               "AttributeBegin " + placed(flies) +
                               "Shape \"sphere\" \"float radius\" 0.25 AttributeEnd\n");
      },
      kLightMixes);
}

/// More lights than are asked one by one: scraps of a mesh that turns, a cylinder, a triangle with vertex
/// normals that turn it round.
TEST(Motion, ManyLightsThatMove) {
  const Path turns{{-0.5, 2, 0.2}, {0.6, 2.1, 0.5}, 0, 150, {0.2, 0, 1}, {1, 0.5, 0.5}, {1, 0.5, 0.5}};
  const Path rolls{{1.2, 1.8, 0}, {0.8, 1.6, 0.3}, 0, 90, {0, 1, 0}};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  std::string indices, points;
  for (int t = 0; t < 18; ++t) {
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    indices += fmt::format("{} {} {} ", 3 * t, 3 * t + 1, 3 * t + 2);
    points += fmt::format("{} {} {}  {} {} {}  {} {} {} ", x, y, z, x + 0.2, y + uniform(random) / 3, z, x, y,
                          z + 0.3);
  }
  expect_as_standing(
      [&](const Placer& placed) {
        return room(
            kDown,
            lit(placed(turns) + "Shape \"trianglemesh\" \"integer indices\" [" + indices + "] \"point P\" [" +
                    points + "]",
                "9 7 5") +
                lit(placed(rolls) + "Shape \"cylinder\" \"float radius\" 0.1 \"float zmin\" -0.2 \"float "
                                    "zmax\" 0.2",
                    "3 6 8") +
                lit(placed(rolls) +
                        "Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point P\" [-0.9 0.6 0  -0.4 "
                        "0.6 0  -0.9 0.7 0.6] \"normal N\" [0 -1 0  0 -1 0  0 -1 0]",
                    "9 3 9"));
      },
      {"bsdf:3", "sa:1", "bsdf:1+line-sa@u:1"});
}

/// In fog, by points and from the light.
TEST(Motion, ALightThatMovesInFog) {
  const Path swings{{-0.8, 1.7, 0.4}, {0.7, 1.5, 0.4}, -40, 80, {0, 0, 1}};
  const std::string quad =
      "Shape \"quad\" \"point o\" [-0.3 0 -0.2] \"vector u\" [0.6 0 0] \"vector v\" [0 0 0.4]";
  expect_as_standing(
      [&](const Placer& placed) {
        return "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0.05 0.05 0.05] "
               "\"rgb "
               "sigma_s\" [0.2 0.2 0.2]\n" +
               room(kDown,
                    "AttributeBegin MediumInterface \"fog\" \"\" Material \"interface\" Translate 0 1 0.3 "
                    "Shape "
                    "\"sphere\" \"float radius\" 1.1 AttributeEnd\n" +
                        lit(placed(swings) + quad, "14 6 2"));
      },
      {"bsdf:1+sa:1", "line-sa@u:1", "sa:1/balance/medium=line"});
}

/// Mirrors see what moves at the time of the ray that looks into them, and move themselves.
TEST(Motion, MirrorsThatTurn) {
  const Path turns{{0, 0.8, 0.4}, {0, 0.8, 0.4}, -20, 50, {0, 1, 0}},
      falls{{-0.7, 1.6, -0.6}, {-0.5, 0.4, -0.6}};
  expect_as_standing(
      [&](const Placer& placed) {
        return room(
            camera(),
            "AttributeBegin Material \"mirror\" " + placed(turns) +
                "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point P\" [-0.7 -0.6 0  0.7 "
                "-0.6 0  0.7 0.6 0  -0.7 0.6 0] AttributeEnd\nAttributeBegin " +
                placed(falls) + "Shape \"sphere\" \"float radius\" 0.25 AttributeEnd\n");
      },
      {"sa:1", "line-sa@u:1", "sa:1/balance/motion=line"});
}

/// The camera moves on a path of its own: its text is the inverse of a placement, turned about the world's y.
TEST(Motion, ACameraThatFliesAndTurns) {
  const Path flies{{-0.8, 1, 0}, {0.5, 0.9, 0.2}};
  for (const char* lens : {"", "\"float lensradius\" 0.15 \"float focaldistance\" 4"}) {
    const bool open = *lens != 0;
    expect_as_standing(
        [&](const Placer& placed) {
          // World to camera: x' = R⁻¹ (x − c). pbrt's text composes to the right, so: rotate by −angle, then
          // −c.
          const Path turn{{0, 0, 0}, {0, 0, 0}, -8, 14, {0, 1, 0}};
          const auto inverse = [](double t) {
            return fmt::format("Rotate {} 0 1 0 Translate {} -1.2 {}\n", 8 - 14 * t, -(-0.6 + 1.1 * t),
                               4.6 - 0.5 * t);
          };
          const std::string probe = placed(turn);
          const bool moves = probe.starts_with("ActiveTransform");
          double t = 0;
          if (!moves) t = (std::stod(probe.substr(probe.find("Rotate") + 7)) + 8) / 14;
          const std::string text = moves
                                       ? "ActiveTransform StartTime " + inverse(0) +
                                             "ActiveTransform EndTime " + inverse(1) + "ActiveTransform All\n"
                                       : inverse(t);
          return room(
              text + "Camera \"perspective\" \"float fov\" 42 " + lens + "\n",
              "AttributeBegin " + placed(flies) + "Shape \"sphere\" \"float radius\" 0.35 AttributeEnd\n");
        },
        open ? std::vector<std::string>{"sa:1", "sa:1/balance/lens=line", "sa:1/balance/motion=line"}
             : std::vector<std::string>{"sa:1", "line-sa@u:1", "sa:1/balance/motion=line"});
  }
}

/// A shutter that opens before the motion begins and closes after it ends, in other units of time.
TEST(Motion, ShutterAndTransformTimes) {
  const Path flies{{-1, 0.9, 0}, {1, 0.9, 0}};
  expect_as_standing(
      [&](const Placer& placed) {
        return "TransformTimes 10 14\n" + room(camera("\"float shutteropen\" 9 \"float shutterclose\" 13"),
                                               "AttributeBegin " + placed(flies) + kPlate +
                                                   "Shape \"sphere\" \"float radius\" 0.3 AttributeEnd\n");
      },
      {"sa:1", "line-sa@v:1", "sa:1/balance/motion=line"}, -0.25, 0.75);
}

TEST(Motion, TouchingMoversAndVeryFastOnes) {
  const Path low{{-0.6, 0.8, 0}, {0.6, 0.8, 0}}, high{{-0.6, 1.1, 0}, {0.6, 1.1, 0}};
  const Path fast{{-40, 1.6, 0.2}, {40, 1.8, 0.2}};
  expect_as_standing(
      [&](const Placer& placed) {
        return room(camera(), "AttributeBegin " + placed(low) + "Shape \"sphere\" \"float radius\" 0.15 " +
                                  kPlate + "AttributeEnd AttributeBegin " + placed(high) +
                                  "Shape \"sphere\" \"float radius\" 0.15 AttributeEnd AttributeBegin " +
                                  placed(fast) + "Scale 12 1 1 " + kPlate + "AttributeEnd\n");
      },
      {"sa:1", "bsdf:1+line-sa@u:1", "sa:1/balance/motion=line"});
}

/// A black plate before a light that fills the picture: its edge goes evenly from the left border to the
/// right one, so a column is dark for as long as it has been passed, and the picture is linear across.
TEST(Motion, AnEdgeBeforeALightIsARamp) {
  const std::string text = R"(LookAt 0 0 0  0 0 1  0 1 0
Camera "perspective" "float fov" 90
PixelFilter "box" "float xwidth" 0.5 "float ywidth" 0.5
WorldBegin
AttributeBegin AreaLightSource "diffuse" "rgb L" [3 3 3] Material "matte" "rgb Kd" [0 0 0]
Shape "quad" "point o" [9 -9 4] "vector u" [-18 0 0] "vector v" [0 18 0] AttributeEnd
AttributeBegin Material "matte" "rgb Kd" [0 0 0]
ActiveTransform EndTime Translate 4 0 0 ActiveTransform All
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point P" [-90 -9 2  -2 -9 2  -2 9 2  -90 9 2] AttributeEnd
)";
  const ScenePtr scene = test::load_text(text);
  ASSERT_TRUE(scene);
  const int edge = 16;
  for (const char* mix : {"sa:1", "sa:1/balance/motion=line"}) {
    const FilmImage image = test::render(*scene, test::job(edge, edge, {mix}, 64)).images[0];
    // LookAt down +z with +y up has +x at the right of the picture in pbrt's left-handed camera space.
    for (int x = 0; x < edge; ++x) {
      double mean = 0, variance = 0;
      for (int y = 0; y < edge; ++y) {
        mean += double(image.rgb[size_t(y * edge + x) * 3]) / edge;
        variance += double(image.variance[size_t(y * edge + x) * 3]) / (edge * edge);
      }
      // The edge is at -1 + 2 t of the picture's half width; a column is lit until it is there.
      const double expected = 3 * (x + 0.5) / edge;
      EXPECT_NEAR(mean, expected, 4.5 * std::sqrt(variance) + 1e-4) << mix << " column " << x;
    }
    if (std::string(mix).ends_with("line")) {
      // What is left is the film's position within the pixel: a line knows the rest.
      double variance = 0;
      for (size_t i = 0; i < image.rgb.size(); i += 3)
        variance += double(image.variance[i]) * 64 / (edge * edge);
      EXPECT_LT(variance, 9.0 / (12 * edge * edge) * 1.5);
    }
  }
}

/// Points against lines in the gallery's scene.
TEST(Motion, AllStrategiesAgree) {
  test::AgreementSpec how;
  how.width = 48;
  how.height = 32;
  how.passes = 32;
  std::vector<std::string> mixes = kMixes;
  mixes.insert(mixes.end(), {"line-analytic@0:1", "sa:1+line-sa@u:1/smooth=auto", "sa:16"});
  test::expect_agreement(test::load(PENUMBRA_SOURCE_DIR "/scenes/gallery/motion.pbrt"), mixes, how);
}

/// A motion too small to see is the picture of the same scene standing.
TEST(Motion, AMotionOfNearlyNothing) {
  const auto text = [](double by) {
    return room(camera(),
                fmt::format("AttributeBegin Translate 0.2 0.9 0 ActiveTransform EndTime Translate {} 0 0 "
                            "ActiveTransform All Shape \"sphere\" \"float radius\" 0.5 AttributeEnd\n",
                            by));
  };
  const ScenePtr still = test::load_text(text(0)), tiny = test::load_text(text(1e-9));
  const JobSpec job = test::job(kWidth, kHeight, {"bsdf:1+sa:1", "line-sa@u:1"}, 8);
  const test::Rendered a = test::render(*still, job), b = test::render(*tiny, job);
  for (size_t m = 0; m < 2; ++m) {
    double sum = 0, apart = 0;
    for (size_t i = 0; i < a.images[m].rgb.size(); ++i) {
      sum += double(a.images[m].rgb[i]);
      apart += std::abs(double(a.images[m].rgb[i]) - double(b.images[m].rgb[i]));
    }
    // The same numbers in other roundings: only what grazes an edge may part.
    EXPECT_LT(apart, 2e-3 * sum) << m;
  }
}

}  // namespace
}  // namespace penumbra

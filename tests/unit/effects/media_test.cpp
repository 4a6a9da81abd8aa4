// Which medium is where along a ray: boundaries from both sides, touching each other and surfaces, vacuum
// between, transforms that swap handedness; and what the scene language may ask for in vain.
#include "worker/effects/media.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "proto/status.h"
#include "scenes/parser.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const char* const kMedia = R"(
MakeNamedMedium "a" "string type" "homogeneous" "rgb sigma_a" [1 1 1] "rgb sigma_s" [0 0 0]
MakeNamedMedium "b" "string type" "homogeneous" "rgb sigma_a" [2 2 2] "rgb sigma_s" [1 1 1]
)";

/// A box [x0,x1] × [-1,1]², seen from outside counterclockwise.
std::string box(double x0, double x1) {
  const auto n = [](double x) { return std::to_string(x); };
  const std::string l = n(x0), r = n(x1);
  return "Shape \"trianglemesh\" \"integer indices\" [0 2 1 0 3 2 4 5 6 4 6 7 0 1 5 0 5 4 1 2 6 1 6 5 2 3 7 "
         "2 7 6 3 0 4 3 4 7]"
         " \"point P\" [" +
         l + " -1 -1 " + r + " -1 -1 " + r + " 1 -1 " + l + " 1 -1 " + l + " -1 1 " + r + " -1 1 " + r +
         " 1 1 " + l + " 1 1]\n";
}
std::string bounded(const std::string& media, const std::string& shape) {
  return "AttributeBegin MediumInterface " + media + " Material \"interface\" " + shape + "AttributeEnd\n";
}

class Scene {
 public:
  explicit Scene(const std::string& text)
      : folder_(std::filesystem::temp_directory_path() / ("penumbra-media-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
    std::ofstream(folder_ / "scene.pbrt") << text;
    const FolderFiles files(folder_.string());
    const auto description = parse_scene("scene.pbrt", files);
    EXPECT_TRUE(description.ok()) << description.status();
    auto built = Media::build(*description, files, {}, 1);
    status = built.status();
    if (built.ok()) media = *std::move(built);
  }
  ~Scene() { std::filesystem::remove_all(folder_); }

  /// `medium t0 t1` of every piece, then the medium at the end.
  std::vector<std::string> along(Media::Way way) const {
    std::vector<Crossing> crossings;
    std::vector<MediumPiece> pieces;
    const int end = media->pieces(way, crossings, pieces);
    std::vector<std::string> out;
    for (const MediumPiece& p : pieces)
      out.push_back(fmt::format("{} {:.4g} {:.4g}", "ab"[p.medium], p.t0, p.t1));
    out.push_back(end < 0 ? "vacuum" : std::string(1, "ab"[end]));
    return out;
  }
  std::vector<std::string> along_x(float from, double distance = kInfinity, int medium = -1) const {
    return along({{from, 0.1f, 0.2f}, {1, 0, 0}, distance, medium});
  }

  std::optional<Media> media;
  absl::Status status;

 private:
  std::filesystem::path folder_;
};

std::string world(const std::string& shapes) {
  return kMedia + ("WorldBegin\n" + shapes);
}

TEST(Media, ABoxIsEnteredAndLeft) {
  const Scene s(world(bounded(R"("a" "")", box(0, 1))));
  EXPECT_THAT(s.along_x(-2), ElementsAre("a 2 3", "vacuum"));
  EXPECT_THAT(s.along_x(-2, 2.5), ElementsAre("a 2 2.5", "a"));
  EXPECT_THAT(s.along_x(0.25f, kInfinity, 0), ElementsAre("a 0 0.75", "vacuum"));
  EXPECT_THAT(s.along({{2, 0, 0}, {-1, 0, 0}, kInfinity, -1}), ElementsAre("a 1 2", "vacuum"));
}

TEST(Media, TheMediumOutsideHasNoEnd) {
  const Scene s(world(bounded(R"("" "b")", box(0, 1))));
  EXPECT_THAT(s.along_x(-2, kInfinity, 1), ElementsAre("b 0 2", "b 3 inf", "b"));
}

TEST(Media, BoxesThatTouchLeaveNoGapAndNoneTooMany) {
  // Both orders in the file, both directions; thirds, so that the shared wall is rounded.
  for (const bool turned : {false, true}) {
    const std::string first = bounded(R"("a" "")", box(0, 1. / 3)),
                      second = bounded(R"("b" "")", box(1. / 3, 1));
    const Scene s(world(turned ? second + first : first + second));
    EXPECT_THAT(s.along_x(-1), ElementsAre("a 1 1.333", "b 1.333 2", "vacuum"));
    EXPECT_THAT(s.along({{2, 0.3f, 0.1f}, {-1, 0, 0}, kInfinity, -1}),
                ElementsAre("b 1 1.667", "a 1.667 2", "vacuum"));
  }
}

TEST(Media, VacuumBetweenBoxes) {
  const Scene s(world(bounded(R"("a" "")", box(0, 1)) + bounded(R"("b" "")", box(3, 4))));
  EXPECT_THAT(s.along_x(-1), ElementsAre("a 1 2", "b 4 5", "vacuum"));
}

TEST(Media, TheEdgeBetweenTwoTrianglesCountsOnce) {
  const Scene s(world(bounded(R"("a" "")", box(0, 1))));
  for (const float y : {-0.5f, 0.f, 0.5f})  // on the diagonals of the walls, and at their centre
    for (const float z : {-y, y})
      EXPECT_THAT(s.along({{-1, y, z}, {1, 0, 0}, kInfinity, -1}), ElementsAre("a 1 2", "vacuum"));
}

TEST(Media, SidesFollowOrientationAndHandedness) {
  for (const char* const sphere :
       {"MediumInterface \"a\" \"\" Material \"none\" Shape \"sphere\"\n",
        "MediumInterface \"\" \"a\" Material \"\" ReverseOrientation Shape \"sphere\"\n",
        "MediumInterface \"a\" \"\" Material \"interface\" Scale -1 1 1 Shape \"sphere\"\n"}) {
    const Scene s(world(sphere));
    EXPECT_THAT(s.along({{-2, 0, 0}, {1, 0, 0}, 2, -1}), ElementsAre("a 1 2", "a")) << sphere;
  }
}

TEST(Media, BoundariesMoveWithInstances) {
  const Scene s(world("ObjectBegin \"o\"\n" + bounded(R"("a" "")", box(0, 1)) +
                      "ObjectEnd\nTranslate 5 0 0 ObjectInstance \"o\"\nScale -1 1 1 Translate 20 0 0 "
                      "ObjectInstance \"o\"\n"));
  EXPECT_THAT(s.along_x(0), ElementsAre("a 5 6", "vacuum"));
  EXPECT_THAT(s.along({{0, 0.1f, 0.2f}, {-1, 0, 0}, kInfinity, -1}), ElementsAre("a 15 16", "vacuum"));
}

TEST(Media, ABoundaryThatTouchesASurfaceIsNotCrossedThere) {
  const Scene s(world(bounded(R"("a" "")", box(0, 1. / 3))));
  const float wall = 1.f / 3;
  EXPECT_THAT(s.along({{-1, 0, 0}, {1, 0, 0}, double(1 + wall), -1, false, true}),
              ElementsAre("a 1 1.333", "a"));
  EXPECT_THAT(s.along({{wall, 0, 0}, {-1, 0, 0}, kInfinity, 0, true, false}),
              ElementsAre("a 0 0.3333", "vacuum"));
}

TEST(Media, NamesThatAreNotThereAreVacuum) {
  const Scene s(
      "MakeNamedMedium \"cloud\" \"string type\" \"nanovdb\"\nMediumInterface \"\" \"mist\"\nCamera "
      "\"perspective\"\nWorldBegin\n" +
      bounded(R"("cloud" "haze")", box(0, 1)));
  ASSERT_TRUE(s.media);
  EXPECT_EQ(s.media->at_camera(), -1);
  EXPECT_THAT(s.along_x(-1), ElementsAre("vacuum"));
}

TEST(Media, ValuesOutOfRangeAreErrorsWithTheirPlace) {
  const auto message = [](const std::string& params) {
    return Scene("MakeNamedMedium \"m\" \"string type\" " + params + "\nWorldBegin\n").status.ToString();
  };
  EXPECT_THAT(message("\"homogeneous\" \"rgb sigma_a\" [ 1 -1 1 ]"),
              HasSubstr("scene.pbrt:1:49: sigma_a of medium 'm' is -1"));
  EXPECT_THAT(message("\"homogeneous\" \"float g\" 1"), HasSubstr("scene.pbrt:1:1: g 1 of medium 'm'"));
  EXPECT_THAT(message("\"homogeneous\" \"float scale\" -2"), HasSubstr("scale -2"));
  EXPECT_THAT(message("\"uniformgrid\" \"integer nx\" 2 \"float density\" [ 1 2 3 ]"),
              HasSubstr("3 densities for a grid of 2 x 1 x 1"));
  EXPECT_THAT(message("\"heterogeneous\" \"float density\" [ -1 ]"), HasSubstr("density -1"));
  EXPECT_THAT(message("\"heterogeneous\" \"float density\" [ 1 ] \"point p1\" [ 1 0 1 ]"),
              HasSubstr("no volume"));
}

}  // namespace
}  // namespace penumbra

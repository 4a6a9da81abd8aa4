#include "scenes/curve.h"

#include <gmock/gmock.h>

#include <cmath>

#include "scenes/check.h"
#include "scenes/curve_chords.h"
#include "scenes/needs.h"
#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr char kCubic[] = "\"point3 P\" [0 0 0  1 2 0  3 2 1  4 0 0] ";

absl::StatusOr<Curve> read(std::string_view params, std::vector<std::string>* warnings = nullptr) {
  const SceneFolder folder;
  const auto scene = folder.parse(fmt::format("WorldBegin\nShape \"curve\" {}", params));
  EXPECT_TRUE(scene.ok()) << message_of(scene.status());
  std::vector<std::string> said;
  return curve_of(scene->shapes.at(0), *scene, folder.files(), warnings ? *warnings : said);
}

Curve curve(std::string_view params) {
  auto made = read(params);
  EXPECT_TRUE(made.ok()) << message_of(made.status());
  return made.ok() ? *made : Curve();
}

void expect_error(std::string_view params, std::string_view text) {
  const auto made = read(params);
  ASSERT_FALSE(made.ok()) << params;
  EXPECT_THAT(message_of(made.status()), testing::StartsWith("a.pbrt:2:"));
  EXPECT_THAT(message_of(made.status()), HasSubstr(text));
}

double distance(const Vec3d& a, const Vec3d& b) {
  return (a - b).length();
}

TEST(Curve, DefaultsArePbrts) {
  const Curve c = curve(kCubic);
  EXPECT_EQ(c.type, CurveType::kFlat);
  EXPECT_EQ(c.width0, 1);
  EXPECT_EQ(c.width1, 1);
  ASSERT_EQ(c.pieces.size(), 1u);
  EXPECT_EQ(c.pieces[0][2], Vec3d(3, 2, 1));
  EXPECT_EQ(curve(std::string(kCubic) + "\"float width\" 3 \"float width1\" 0").width0, 3);
  EXPECT_EQ(curve(std::string(kCubic) + "\"float width\" 3 \"float width1\" 0").width1, 0);
}

TEST(Curve, IsNoLongerLeftOut) {
  const SceneDescription scene = parsed(std::string("WorldBegin Shape \"curve\" ") + kCubic);
  EXPECT_THAT(unsupported(scene), IsEmpty());
  EXPECT_TRUE(has_tubes(scene.shapes[0]));
  EXPECT_FALSE(has_mesh(scene.shapes[0]));
}

TEST(Curve, RefusesWhatPbrtRefuses) {
  expect_error("", "P");
  expect_error(std::string(kCubic) + "\"integer degree\" 4", "degree 4");
  expect_error(std::string(kCubic) + "\"string basis\" \"hermite\"", "hermite");
  expect_error(std::string(kCubic) + "\"string type\" \"tube\"", "tube");
  expect_error("\"point3 P\" [0 0 0 1 1 1 2 2 2 3 3 3 4 4 4]", "5 control points");
  expect_error("\"point3 P\" [0 0 0 1 1 1 2 2 2 3 3 3] \"integer degree\" 2", "4 control points");
  expect_error("\"point3 P\" [0 0 0 1 1 1] \"integer degree\" 2 \"string basis\" \"bspline\"",
               "2 control points");
  expect_error(std::string(kCubic) + "\"string type\" \"ribbon\"", "N");
  expect_error(std::string(kCubic) + "\"string type\" \"ribbon\" \"normal N\" [0 0 1]", "2 normals");
  expect_error(std::string(kCubic) + "\"float width\" -1", "width");
  expect_error(std::string(kCubic) + "\"float width\" 0", "width");
}

TEST(Curve, ErrorsReachTheClient) {
  const SceneFolder folder;
  const auto scene = folder.parse("WorldBegin\n  Shape \"curve\" \"integer degree\" 4");
  ASSERT_TRUE(scene.ok());
  EXPECT_THAT(message_of(check_files(*scene, folder.files())), testing::StartsWith("a.pbrt:2:17: "));
}

TEST(Curve, NormalsOfNoRibbonAreLeftOutAndSaid) {
  std::vector<std::string> warnings;
  ASSERT_TRUE(read(std::string(kCubic) + "\"normal N\" [0 0 1 0 0 1]", &warnings).ok());
  EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("a.pbrt:2:")));
}

TEST(Curve, SeveralBezierPiecesShareTheirEnds) {
  const Curve c = curve("\"point3 P\" [0 0 0 1 0 0 2 1 0 3 1 0 4 1 0] \"integer degree\" 2");
  ASSERT_EQ(c.pieces.size(), 2u);
  EXPECT_EQ(c.pieces[0][3], c.pieces[1][0]);
  // A quadratic's middle: a quarter of the ends and half of the inner point.
  EXPECT_LT(distance(point_at(c.pieces[0], 0.5), Vec3d(1, 0.25, 0)), 1e-15);
}

// De Boor's value at the knots, and the same tangent on both sides of them.
TEST(Curve, SplinesAreSmoothAcrossPieces) {
  for (const int degree : {2, 3}) {
    const Curve c = curve(fmt::format(
        "\"point3 P\" [0 0 0 1 3 0 2 -1 1 4 0 0 5 5 2] \"string basis\" \"bspline\" \"integer degree\" {}",
        degree));
    ASSERT_EQ(c.pieces.size(), size_t(5 - degree));
    for (size_t i = 0; i + 1 < c.pieces.size(); ++i) {
      EXPECT_EQ(c.pieces[i][3], c.pieces[i + 1][0]);
      EXPECT_LT(distance(tangent_at(c.pieces[i], 1), tangent_at(c.pieces[i + 1], 0)), 1e-14);
    }
    const Vec3d start = degree == 3 ? (Vec3d(0, 0, 0) + Vec3d(1, 3, 0) * 4. + Vec3d(2, -1, 1)) / 6.
                                    : (Vec3d(0, 0, 0) + Vec3d(1, 3, 0)) / 2.;
    EXPECT_LT(distance(c.pieces[0][0], start), 1e-15);
  }
}

TEST(Curve, ChordsStayWithinATenthOfTheWidth) {
  for (const double width : {1., 0.1, 0.001}) {
    const Curve c =
        curve(fmt::format("{} \"float width0\" {} \"float width1\" {}", kCubic, width, width / 3));
    Tubes tubes;
    EXPECT_TRUE(add_tubes(c, Matrix(), tubes));
    const size_t n = tubes.segments.size();
    EXPECT_EQ(tubes.points.size(), n + 1);
    EXPECT_EQ(tubes.us.front(), 0);
    EXPECT_EQ(tubes.us.back(), 1);
    EXPECT_FLOAT_EQ(tubes.points.front().w, static_cast<float>(width / 2));
    EXPECT_FLOAT_EQ(tubes.points.back().w, static_cast<float>(width / 6));
    double most = 0;
    for (size_t i = 0; i < n; ++i)
      for (int k = 0; k <= 16; ++k) {
        const double s = k / 16.;
        const auto &a = tubes.points[i], &b = tubes.points[i + 1];
        const Vec3d chord = Vec3d(a.x, a.y, a.z) * (1 - s) + Vec3d(b.x, b.y, b.z) * s;
        const Vec3d on = point_at(c.pieces[0], (static_cast<double>(i) + s) / static_cast<double>(n));
        most = std::max(most, distance(chord, on));
      }
    EXPECT_LE(most, kCurveTolerance * width * 1.001);
    // As wide as its bends are, a curve needs more for their sake (below).
    if (width < 1) {
      EXPECT_GE(most, kCurveTolerance * width * 0.2) << "far more chords than are needed";
    }
  }
}

// A bend about as wide as the curve: within a tenth of the width, chords would turn by 0.9 at a joint.
TEST(Curve, ChordsOfAThickCurveHaveNoCorners) {
  const Curve c = curve("\"point3 P\" [0 0 0 0 2 0 1 2 0 1 0 0] \"float width\" 0.2");
  Tubes tubes;
  EXPECT_TRUE(add_tubes(c, Matrix(), tubes));
  double most = 0;
  for (size_t i = 0; i + 2 < tubes.points.size(); ++i) {
    const auto at = [&](size_t k) { return Vec3d(tubes.points[k].x, tubes.points[k].y, tubes.points[k].z); };
    const Vec3d a = at(i + 1) - at(i), b = at(i + 2) - at(i + 1);
    most = std::max(most, std::atan2(a.cross(b).length(), a.dot(b)));
  }
  EXPECT_LE(most, kMostTurn * 1.01);
  EXPECT_LE(tubes.segments.size(), 64u) << "far more chords than are needed";
}

// A hair's bends are far wider than the hair, and a cusp is not refined for ever.
TEST(Curve, ThinCurvesAndCuspsNeedNoMoreChords) {
  const auto segments = [](const std::string& text) {
    const Curve c = curve(text);
    Tubes tubes;
    add_tubes(c, Matrix(), tubes);
    return tubes.segments.size();
  };
  const std::string bend = "\"point3 P\" [0 0 0 0 2 0 1 2 0 1 0 0] \"float width\" ";
  const CurvePiece piece = curve(bend + "0.001").pieces[0];
  EXPECT_EQ(segments(bend + "0.001"), size_t(chords_of(piece, 0.001 * kCurveTolerance)));
  EXPECT_LE(segments("\"point3 P\" [0 0 0 1 1 0 0 1 0 1 0 0] \"float width\" 0.1"), 256u);
}

TEST(Curve, ScalesWithItsTransformAndSaysWhereItCannot) {
  const Curve c = curve(std::string(kCubic) + "\"float width\" 0.2");
  Matrix twice;
  twice.makeIdentity();
  for (int i = 0; i < 3; ++i) twice[i][i] = 2;
  Tubes same, larger, flattened;
  EXPECT_TRUE(add_tubes(c, Matrix(), same));
  EXPECT_TRUE(add_tubes(c, twice, larger));
  EXPECT_EQ(same.segments.size(), larger.segments.size());
  EXPECT_FLOAT_EQ(larger.points[0].w, 0.2f);
  twice[2][2] = 1;
  EXPECT_FALSE(add_tubes(c, twice, flattened));
}

TEST(Curve, ARibbonIsAStripAcrossItsNormals) {
  const SceneFolder folder;
  const auto scene = folder.parse(
      "WorldBegin Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0] \"string type\" \"ribbon\" "
      "\"normal N\" [0 0 1 0 1 0] \"float width\" 0.5");
  ASSERT_TRUE(scene.ok());
  std::vector<std::string> warnings;
  ASSERT_TRUE(has_mesh(scene->shapes[0]));
  const auto mesh = make_mesh(scene->shapes[0], *scene, folder.files(), warnings);
  ASSERT_TRUE(mesh.ok()) << message_of(mesh.status());
  EXPECT_LT((mesh->positions[0] - Vec3f(0, -0.25f, 0)).length(), 1e-6) << "across = N × tangent, v = 0";
  EXPECT_LT((mesh->normals[0] - Vec3f(0, 0, 1)).length(), 1e-6);
  EXPECT_LT((mesh->normals.back() - Vec3f(0, 1, 0)).length(), 1e-6);
  EXPECT_EQ(mesh->uvs.back(), Vec2f(1, 1));
  double area = 0;
  for (size_t i = 0; i < mesh->indices.size(); i += 3) {
    const Vec3f a = mesh->positions[mesh->indices[i]], b = mesh->positions[mesh->indices[i + 1]],
                c = mesh->positions[mesh->indices[i + 2]];
    const Vec3f normal = (b - a).cross(c - a);
    EXPECT_GT(normal.dot(mesh->normals[mesh->indices[i]]), 0);
    area += normal.length() / 2;
  }
  // Each triangle has a cross-section for its base and its apex on an edge, which turns by θ' = π/6 at 1/4
  // from the axis: √(1 + (θ'/4)²) of the flat strip, where the helicoid has the mean of √(1 + (v θ')²) over
  // |v| <= 1/4.
  EXPECT_NEAR(area, 1.5 * std::sqrt(1 + std::pow(M_PI / 6 / 4, 2)), 1e-3);
}

}  // namespace
}  // namespace penumbra

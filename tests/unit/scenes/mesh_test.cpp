#include "scenes/mesh.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Made {
  absl::StatusOr<TriangleMesh> mesh;
  std::vector<std::string> warnings;
};

Made make(std::string_view shape) {
  const SceneFolder folder;
  const auto scene = folder.parse(fmt::format("WorldBegin\nShape {}", shape));
  EXPECT_TRUE(scene.ok()) << message_of(scene.status());
  Made made{TriangleMesh(), {}};
  made.mesh = make_mesh(scene->shapes.at(0), *scene, folder.files(), made.warnings);
  return made;
}

TriangleMesh mesh_of(std::string_view shape) {
  const Made made = make(shape);
  EXPECT_TRUE(made.mesh.ok()) << message_of(made.mesh.status());
  return made.mesh.ok() ? *made.mesh : TriangleMesh();
}

std::string mesh_error(std::string_view shape) {
  const Made made = make(shape);
  EXPECT_FALSE(made.mesh.ok()) << shape;
  EXPECT_THAT(message_of(made.mesh.status()), testing::StartsWith("a.pbrt:2:"));
  return message_of(made.mesh.status());
}

Vec3f normal(const TriangleMesh& mesh, size_t triangle) {
  const auto p = [&](size_t k) { return mesh.positions[mesh.indices[3 * triangle + k]]; };
  return (p(1) - p(0)).cross(p(2) - p(0)).normalized();
}

TEST(TriangleMeshShape, ReadsBothVersionsOfEveryArray) {
  const TriangleMesh v3 = mesh_of(
      "\"trianglemesh\" \"integer indices\" [0 1 2] \"point P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1 0 0 "
      "1 0 0 1] "
      "\"vector S\" [1 0 0 1 0 0 1 0 0] \"float st\" [0 0 1 0 0 1]");
  EXPECT_EQ(v3.positions.at(1), Vec3f(1, 0, 0));
  EXPECT_EQ(v3.normals.at(2), Vec3f(0, 0, 1));
  EXPECT_EQ(v3.tangents.at(2), Vec3f(1, 0, 0));
  EXPECT_EQ(v3.uvs.at(1), Vec2f(1, 0));
  const TriangleMesh v4 =
      mesh_of("\"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 0 0 1]");
  EXPECT_THAT(v4.indices, ElementsAre(0, 1, 2));
  EXPECT_EQ(v4.uvs.at(2), Vec2f(0, 1));
}

TEST(TriangleMeshShape, WrongIndicesAreErrors) {
  EXPECT_THAT(mesh_error("\"trianglemesh\" \"integer indices\" [0 1 9] \"point P\" [0 0 0 1 0 0 0 1 0]"),
              HasSubstr("index 9 is not below the number of vertices, 3"));
  EXPECT_THAT(mesh_error("\"trianglemesh\" \"integer indices\" [0 1 -1] \"point P\" [0 0 0 1 0 0 0 1 0]"),
              HasSubstr("negative"));
  EXPECT_THAT(mesh_error("\"trianglemesh\" \"integer indices\" [0 1] \"point P\" [0 0 0 1 0 0 0 1 0]"),
              HasSubstr("multiple of 3"));
  EXPECT_THAT(mesh_error("\"trianglemesh\" \"integer indices\" [0 1 2]"), HasSubstr("without"));
  EXPECT_THAT(mesh_error("\"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0 1 1 1]"), HasSubstr("without"));
}

TEST(TriangleMeshShape, ArraysOfAnotherLengthAreLeftOutWithAWarning) {
  const Made made = make(
      "\"trianglemesh\" \"point P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 1] \"float uv\" [0 0 1 0 0 1 5 5]");
  ASSERT_TRUE(made.mesh.ok());
  EXPECT_THAT(made.mesh->normals, IsEmpty());
  EXPECT_EQ(made.mesh->uvs.size(), 3u);
  EXPECT_EQ(made.warnings.size(), 2u);
}

TEST(TriangleMeshShape, TrianglesWithoutAreaAreDroppedAndCounted) {
  const Made made = make(
      "\"trianglemesh\" \"integer indices\" [0 1 2  0 0 1  0 3 1  2 1 0] \"point P\" [0 0 0 1 1 1 0 1 0 .3 "
      ".3 .3]");
  ASSERT_TRUE(made.mesh.ok());
  EXPECT_THAT(made.mesh->indices, ElementsAre(0, 1, 2, 2, 1, 0));
  EXPECT_THAT(made.warnings, ElementsAre(HasSubstr("2 of 4 triangles have no area")));
  // Small is not degenerate, whatever the unit.
  EXPECT_EQ(mesh_of("\"trianglemesh\" \"point P\" [0 0 0 1e-18 0 0 0 1e-18 0]").triangles(), 1u);
  EXPECT_EQ(mesh_of("\"trianglemesh\" \"point P\" [1e6 0 0 1000000.0625 0 0 1e6 0.0625 0]").triangles(), 1u);
}

TEST(Quad, FacesAlongUCrossV) {
  const TriangleMesh quad = mesh_of("\"quad\" \"point o\" [1 1 1] \"vector u\" [2 0 0] \"vector v\" [0 0 3]");
  EXPECT_THAT(quad.indices, ElementsAre(0, 1, 2, 0, 2, 3));
  EXPECT_EQ(quad.positions.at(2), Vec3f(3, 1, 4));
  EXPECT_EQ(quad.uvs.at(3), Vec2f(0, 1));
  for (size_t i = 0; i < 2; ++i) EXPECT_EQ(normal(quad, i), Vec3f(0, -1, 0));
  const Made flat = make("\"quad\" \"vector u\" [1 0 0] \"vector v\" [2 0 0]");
  ASSERT_TRUE(flat.mesh.ok());
  EXPECT_EQ(flat.mesh->triangles(), 0u);
  EXPECT_THAT(flat.warnings, ElementsAre(HasSubstr("no area")));
}

TEST(Bilinear, AFlatPatchIsTwoTriangles) {
  const TriangleMesh patch = mesh_of("\"bilinearmesh\" \"point3 P\" [-20 -20 0 20 -20 0 -20 20 0 20 20 0]");
  EXPECT_EQ(patch.triangles(), 2u);
  for (size_t i = 0; i < 2; ++i) EXPECT_EQ(normal(patch, i), Vec3f(0, 0, 1));
  EXPECT_EQ(patch.uvs.at(1), Vec2f(1, 0));
  EXPECT_EQ(patch.positions.at(3), Vec3f(20, 20, 0));
}

TEST(Bilinear, ACurvedPatchFollowsItsSurface) {
  const TriangleMesh patch = mesh_of("\"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]");
  EXPECT_GT(patch.triangles(), 100u);
  for (size_t i = 0; i < patch.positions.size(); ++i) {
    const Vec3f& p = patch.positions[i];
    EXPECT_FLOAT_EQ(p.z, p.x * p.y);
    EXPECT_FLOAT_EQ(p.x, patch.uvs[i].x);
  }
}

TEST(Bilinear, SeveralPatchesAndTheirFaults) {
  EXPECT_EQ(mesh_of("\"bilinearmesh\" \"integer indices\" [0 1 2 3 2 3 4 5] "
                    "\"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0 0 2 0 1 2 0]")
                .triangles(),
            4u);
  EXPECT_THAT(
      mesh_error("\"bilinearmesh\" \"integer indices\" [0 1 2 4] \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]"),
      HasSubstr("index 4"));
  EXPECT_THAT(mesh_error("\"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]"), HasSubstr("indices"));
}

TEST(PlyMeshShape, FaultsNameTheShapeAndTheFile) {
  EXPECT_THAT(mesh_error("\"plymesh\" \"string filename\" \"missing.ply\""), HasSubstr("'missing.ply'"));
  EXPECT_THAT(mesh_error("\"plymesh\" \"string filename\" \"a.pbrt\""), HasSubstr("not a PLY file"));
  EXPECT_THAT(mesh_error("\"plymesh\""), HasSubstr("not a file name"));
  EXPECT_THAT(mesh_error("\"plymesh\" \"string filename\" \".\""), HasSubstr("not a regular file"));
}

TEST(PlyMeshShape, ValuesThatAreNotFiniteAreErrors) {
  const SceneFolder folder;
  folder.write(
      "m.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1e300 0 0 0 1 0 3 0 1 2");
  const auto scene = folder.parse("WorldBegin Shape \"plymesh\" \"string filename\" \"m.ply\"");
  std::vector<std::string> warnings;
  const auto mesh = make_mesh(scene->shapes.at(0), *scene, folder.files(), warnings);
  EXPECT_THAT(message_of(mesh.status()), HasSubstr("position of vertex 1 is not finite"));
}

TEST(HasMesh, KnowsWhatIsRendered) {
  for (const char* const type :
       {"trianglemesh", "plymesh", "quad", "bilinearmesh", "loopsubdiv", "sphere", "disk", "cylinder"})
    EXPECT_TRUE(has_mesh(ShapeEntity{{type, {}, {}}})) << type;
  EXPECT_FALSE(has_mesh(ShapeEntity{{"cone", {}, {}}}));
}

// ---- Loop subdivision ----

constexpr std::string_view kOctahedron =
    "\"loopsubdiv\" \"integer indices\" [0 2 4  2 1 4  1 3 4  3 0 4  2 0 5  1 2 5  3 1 5  0 3 5] "
    "\"point P\" [1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1 0 0 -1]";

TEST(LoopSubdivision, AnOctahedronBecomesRound) {
  const TriangleMesh mesh = mesh_of(fmt::format("{} \"integer levels\" 4", kOctahedron));
  EXPECT_EQ(mesh.triangles(), 8u * 256);
  EXPECT_EQ(mesh.positions.size(), 4u * 256 + 2);  // Euler
  float least = std::numeric_limits<float>::max(), most = 0;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const float r = mesh.positions[i].length();
    least = std::min(least, r);
    most = std::max(most, r);
    // pbrt's normals of this surface point against the winding of its control faces: inwards here.
    EXPECT_LT(mesh.normals[i].dot(mesh.positions[i].normalized()), -0.9f);
    EXPECT_NEAR(mesh.normals[i].length(), 1, 1e-6f);
  }
  EXPECT_LT(most / least, 1.25f);
  // Faces and vertex normals agree which side is the front.
  for (size_t t = 0; t < mesh.triangles(); ++t)
    EXPECT_GT(normal(mesh, t).dot(mesh.normals[mesh.indices[3 * t]]), 0.9f);
}

TEST(LoopSubdivision, TheLimitDoesNotDependOnTheLevel) {
  // A vertex of the control mesh keeps its index; its limit position is the same from every level.
  const TriangleMesh coarse = mesh_of(fmt::format("{} \"integer levels\" 0", kOctahedron));
  const TriangleMesh fine = mesh_of(fmt::format("{} \"integer nlevels\" 5", kOctahedron));
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_LT((coarse.positions[i] - fine.positions[i]).length(), 1e-6f);
    EXPECT_LT((coarse.normals[i] - fine.normals[i]).length(), 1e-5f);
  }
}

TEST(LoopSubdivision, AFlatGridStaysFlatAndItsBoundaryIsASpline) {
  const TriangleMesh mesh = mesh_of(
      "\"loopsubdiv\" \"integer levels\" 2 \"integer indices\" [0 1 4 0 4 3 1 2 5 1 5 4 3 4 7 3 7 6 4 5 8 4 "
      "8 7] "
      "\"point P\" [0 0 7 1 0 7 2 0 7 0 1 7 1 1 7 2 1 7 0 2 7 1 2 7 2 2 7]");
  EXPECT_EQ(mesh.triangles(), 8u * 16);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_FLOAT_EQ(mesh.positions[i].z, 7);
    EXPECT_FLOAT_EQ(mesh.normals[i].z, -1);
    EXPECT_GE(mesh.positions[i].x, 0);
  }
  EXPECT_EQ(mesh.positions.at(4), Vec3f(1, 1, 7));
  // Limit of a cubic B-spline at a knot: (1 4 1)/6 of points 0, 1, 2; pbrt takes 1/5 3/5 1/5.
  EXPECT_FLOAT_EQ(mesh.positions.at(1).x, 1);
}

TEST(LoopSubdivision, FaultsOfTheControlMeshAreErrors) {
  EXPECT_THAT(mesh_error("\"loopsubdiv\" \"integer indices\" [0 1 2 0 1 3 0 1 4] "
                         "\"point P\" [0 0 0 1 0 0 0 1 0 0 0 1 1 1 1]"),
              HasSubstr("3 faces meet"));
  EXPECT_THAT(
      mesh_error("\"loopsubdiv\" \"integer indices\" [0 1 2 0 1 3] \"point P\" [0 0 0 1 0 0 0 1 0 0 0 1]"),
      HasSubstr("wind against"));
  EXPECT_THAT(mesh_error(fmt::format("{} \"integer levels\" 14", kOctahedron)), HasSubstr("14 levels"));
  EXPECT_THAT(mesh_error(fmt::format("{} \"integer levels\" -1", kOctahedron)), HasSubstr("-1 levels"));
  EXPECT_THAT(mesh_error("\"loopsubdiv\" \"integer indices\" [0 1 7] \"point P\" [0 0 0 1 0 0 0 1 0]"),
              HasSubstr("index 7"));
}

}  // namespace
}  // namespace penumbra

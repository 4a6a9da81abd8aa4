#include "scenes/ply.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Bytes of values one after the other, big- or little-endian.
class Bytes {
 public:
  explicit Bytes(bool big_endian = false) : big_endian_(big_endian) {}
  template <class T>
  Bytes& add(std::initializer_list<T> values) {
    for (const T value : values) {
      char raw[sizeof(T)];
      std::memcpy(raw, &value, sizeof(T));
      if (big_endian_) std::reverse(raw, raw + sizeof(T));
      bytes_.append(raw, sizeof(T));
    }
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  bool big_endian_;
  std::string bytes_;
};

constexpr std::string_view kTriangle = R"(ply
format ascii 1.0
comment a triangle, with blanks at the ends of lines
element vertex 3 
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
)";

std::string header(std::string_view format, std::string_view vertices, std::string_view faces,
                   std::string_view vertex_extra = "", std::string_view list = "uchar int") {
  return fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n{}"
      "element face {}\nproperty list {} vertex_indices\nend_header\n",
      format, vertices, vertex_extra, faces, list);
}

TriangleMesh mesh_of(std::string_view bytes) {
  const auto ply = read_ply(bytes);
  EXPECT_TRUE(ply.ok()) << message_of(ply.status());
  return ply.ok() ? ply->mesh : TriangleMesh();
}

std::string ply_error(std::string_view bytes) {
  const auto ply = read_ply(bytes);
  EXPECT_FALSE(ply.ok());
  return message_of(ply.status());
}

TEST(Ply, Ascii) {
  const TriangleMesh mesh = mesh_of(kTriangle);
  EXPECT_THAT(mesh.indices, ElementsAre(0, 1, 2));
  EXPECT_EQ(mesh.positions.at(1), Vec3f(1, 0, 0));
  EXPECT_THAT(mesh.normals, IsEmpty());
}

class BinaryPly : public testing::TestWithParam<bool> {};

TEST_P(BinaryPly, PolygonsBecomeFansInBothByteOrders) {
  const bool big = GetParam();
  Bytes body(big);
  body.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 0.5f, 0});
  body.add<uint8_t>({4}).add<int32_t>({0, 1, 2, 3});
  body.add<uint8_t>({5}).add<int32_t>({4, 0, 1, 2, 3});
  const TriangleMesh mesh =
      mesh_of(header(big ? "binary_big_endian" : "binary_little_endian", "5", "2") + body.str());
  EXPECT_THAT(mesh.indices, ElementsAre(0, 1, 2, 0, 2, 3, 4, 0, 1, 4, 1, 2, 4, 2, 3));
  EXPECT_EQ(mesh.positions.at(4), Vec3f(-1, 0.5f, 0));
}

TEST_P(BinaryPly, EveryTypeIsRead) {
  const bool big = GetParam();
  const std::string text = fmt::format(
      "ply\nformat {} 1.0\nelement vertex 3\nproperty double x\nproperty short y\nproperty uint8 z\n"
      "property int8 quality\nproperty list ushort float weights\nelement face 1\nproperty uint flags\n"
      "property list int ushort vertex_index\nend_header\n",
      big ? "binary_big_endian" : "binary_little_endian");
  Bytes body(big);
  for (const int16_t k : {0, 1, 2})
    body.add<double>({0.5 * k})
        .add<int16_t>({static_cast<int16_t>(-300 * k * k)})
        .add<uint8_t>({200})
        .add<int8_t>({-1})
        .add<uint16_t>({2})
        .add<float>({1, 2});
  body.add<uint32_t>({7}).add<int32_t>({3}).add<uint16_t>({2, 1, 0});
  const TriangleMesh mesh = mesh_of(text + body.str());
  EXPECT_EQ(mesh.positions.at(2), Vec3f(1, -1200, 200));
  EXPECT_THAT(mesh.indices, ElementsAre(2, 1, 0));
}

INSTANTIATE_TEST_SUITE_P(ByteOrders, BinaryPly, testing::Bool(),
                         [](const auto& big) { return big.param ? "Big" : "Little"; });

TEST(Ply, NormalsAndEverySpellingOfTextureCoordinates) {
  for (const auto& [u, v] :
       {std::pair("u", "v"), {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}) {
    const std::string extra = fmt::format(
        "property float nx\nproperty float ny\nproperty float nz\nproperty float {}\nproperty float {}\n", u,
        v);
    const TriangleMesh mesh = mesh_of(header("ascii", "3", "1", extra) +
                                      "0 0 0 0 0 1 .1 .2\n1 0 0 0 0 1 .3 .4\n0 1 0 0 0 1 .5 .6\n3 0 1 2");
    EXPECT_EQ(mesh.normals.at(1), Vec3f(0, 0, 1));
    EXPECT_EQ(mesh.uvs.at(2), Vec2f(.5f, .6f)) << u;
  }
}

TEST(Ply, OtherElementsAreSkippedAndWindowsLineEndsRead) {
  std::string text =
      "ply\r\nformat ascii 1.0\r\nelement camera 1\r\nproperty list uchar float k\r\nproperty int id\r\n"
      "element vertex 3\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\nelement face 1\r\n"
      "property list uchar uint vertex_indices\r\nelement edge 1\r\nproperty int vertex1\r\nproperty int "
      "vertex2\r\nelement nothing 4000000000\r\nend_header\r\n2 0.5 0.5 9\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 "
      "1 "
      "2\r\n0 1\r\n";
  EXPECT_THAT(mesh_of(text).indices, ElementsAre(0, 1, 2));
}

TEST(Ply, FacesOfFewerThanThreeVerticesAreCounted) {
  const auto ply = read_ply(header("ascii", "3", "3") + "0 0 0 1 0 0 0 1 0  2 0 1  3 0 1 2  0");
  ASSERT_TRUE(ply.ok()) << message_of(ply.status());
  EXPECT_EQ(ply->short_faces, 2u);
  EXPECT_EQ(ply->mesh.triangles(), 1u);
}

TEST(Ply, LiesAboutSizesAreFoundBeforeAnythingIsAllocated) {
  EXPECT_THAT(ply_error(header("binary_little_endian", "4000000000", "1") + "x"), HasSubstr("promises"));
  EXPECT_THAT(ply_error(header("binary_little_endian", "1", "18446744073709551615") + std::string(100, '\0')),
              HasSubstr("promises"));
  EXPECT_THAT(ply_error(header("ascii", "1000000", "1") + "0 0 0"), HasSubstr("promises"));
  EXPECT_THAT(ply_error(header("ascii", "5000000000", "1")), HasSubstr("2^32"));
}

TEST(Ply, TruncatedAndOverlongBodiesAreErrors) {
  const std::string whole(kTriangle.substr(0, kTriangle.size() - 1));
  for (size_t cut = whole.size() - 1; cut > 0; --cut)
    EXPECT_FALSE(read_ply(std::string_view(whole).substr(0, cut)).ok()) << cut;
  EXPECT_THAT(ply_error(whole + " 7"), HasSubstr("follow its last element"));
  EXPECT_TRUE(read_ply(whole + "\n \r\n").ok());
  Bytes body;
  body.add<float>({0, 0, 0}).add<uint8_t>({255}).add<int32_t>({0, 0});
  EXPECT_THAT(ply_error(header("binary_little_endian", "1", "1") + body.str()), HasSubstr("face 0 of 1"));
}

TEST(Ply, IndicesOutOfRangeAreErrors) {
  EXPECT_THAT(ply_error(header("ascii", "3", "1") + "0 0 0 1 0 0 0 1 0  3 0 1 3"),
              HasSubstr("vertex index 3 is not from 0 to 2"));
  EXPECT_THAT(ply_error(header("ascii", "3", "1") + "0 0 0 1 0 0 0 1 0  3 0 1 -1"), HasSubstr("index -1"));
  EXPECT_THAT(ply_error(header("ascii", "3", "1") + "0 0 0 1 0 0 0 1 0  3 0 1 nan"), HasSubstr("index nan"));
  EXPECT_THAT(ply_error(header("ascii", "1", "1", "", "char int") + "0 0 0  -3 0"), HasSubstr("-3 vertices"));
}

TEST(Ply, HeaderFaultsNameTheirLine) {
  EXPECT_THAT(ply_error("plyx\n"), HasSubstr("not a PLY file"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 1\n"), HasSubstr("no end_header"));
  EXPECT_THAT(ply_error("ply\nformat ascii 2.0\n"), HasSubstr("line 2"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex -1\n"), HasSubstr("line 3"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nproperty float x\n"), HasSubstr("before the first element"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement a 1\nproperty half x\n"),
              HasSubstr("line 4: unknown type"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement a 1\nelement a 1\n"), HasSubstr("second element"));
  EXPECT_THAT(ply_error("ply\nelement vertex 0\nelement face 0\nend_header\n"), HasSubstr("no format"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n"),
              HasSubstr("lacks an element"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nfrobnicate\n"), HasSubstr("unknown word"));
}

TEST(Ply, GzipIsUnpacked) {
  const SceneFolder folder;
  const gzFile file = gzopen(folder.path("a.ply.gz").c_str(), "wb");
  gzwrite(file, kTriangle.data(), static_cast<unsigned>(kTriangle.size()));
  gzclose(file);
  const auto scene = folder.parse("WorldBegin Shape \"plymesh\" \"string filename\" \"a.ply.gz\"");
  ASSERT_TRUE(scene.ok());
  std::vector<std::string> warnings;
  const auto mesh = make_mesh(scene->shapes.at(0), *scene, folder.files(), warnings);
  ASSERT_TRUE(mesh.ok()) << message_of(mesh.status());
  EXPECT_EQ(mesh->triangles(), 1u);
  EXPECT_TRUE(check_ply_file(folder.path("a.ply.gz")).ok());
}

TEST(Ply, TheQuickCheckSeesMissingBytes) {
  const SceneFolder folder;
  folder.write("good.ply", kTriangle);
  EXPECT_TRUE(check_ply_file(folder.path("good.ply")).ok());
  folder.write("short.ply", header("binary_little_endian", "100", "1") + std::string(200, '\0'));
  EXPECT_THAT(message_of(check_ply_file(folder.path("short.ply"))), HasSubstr("promises"));
  EXPECT_FALSE(check_ply_file(folder.path("none.ply")).ok());
}

}  // namespace
}  // namespace penumbra

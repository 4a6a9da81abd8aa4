// Damaged input: seeded random flips, cuts and repetitions of small scenes and meshes. Nothing may crash,
// hang or allocate more than a small multiple of its input; errors name a place.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <ctime>
#include <random>

#include "scenes/bundle.h"
#include "scenes/check.h"
#include "scenes/mesh.h"
#include "scenes/needs.h"
#include "scenes/ply.h"
#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

constexpr int kMutants = 3000;
constexpr double kMostSecondsEach = 1;
constexpr long kMostGrowthKilobytes = 512 * 1024;

long peak_kilobytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

std::string mutated(std::string text, std::mt19937& random) {
  const auto below = [&random](size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random); };
  for (size_t times = 1 + below(4); times > 0 && !text.empty(); --times) {
    const size_t at = below(text.size());
    switch (below(6)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text[at] = "0123456789-.eE\"[]# \n"[below(20)];
        break;
      case 2:
        text.resize(at);
        break;
      case 3:
        text.erase(at, below(20));
        break;
      case 4:
        text.insert(at, text.substr(below(text.size()), below(60)));
        break;
      default:
        text.insert(at, std::vector<std::string>{"1e38", "-1", "4294967296", "nan", "99999999999999999999",
                                                 "0 0 0", "Include \"a.pbrt\" "}[below(7)]);
    }
  }
  return text;
}

/// Runs `use` on mutants of each seed text and watches clock and memory.
template <class Use>
void survive(const std::vector<std::string>& seeds, Use&& use) {
  std::mt19937 random(20190101);
  const long before = peak_kilobytes();
  for (int i = 0; i < kMutants; ++i) {
    const std::string text = mutated(seeds[i % seeds.size()], random);
    const std::clock_t start = std::clock();
    use(text);
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, kMostSecondsEach) << text;
  }
  EXPECT_LT(peak_kilobytes() - before, kMostGrowthKilobytes);
}

const char kScene[] = R"(LookAt 3 4 1.5 .5 .5 0 0 0 1 # eye
Camera "perspective" "float fov" [45] "float lensradius" 0.1
Film "image" "integer xresolution" [64] "integer yresolution" [48] "string filename" "a.exr"
Sampler "halton" "integer pixelsamples" 8 Integrator "path"
WorldBegin
LightSource "infinite" "rgb L" [.4 .45 .5] "string mapname" "sky.exr"
Texture "Map #0" "spectrum" "checkerboard" "float uscale" [8] "rgb tex1" [.1 .1 .1]
MakeNamedMaterial "m" "string type" "matte" "texture Kd" "Map #0"
AttributeBegin
  Material "glass" AreaLightSource "diffuse" "blackbody L" [6500 100]
  Translate 0 0 -1 Rotate 135 1 0 0 Scale 2 2 2
  Shape "quad" "point o" [0 0 0] "vector u" [1 0 0] "vector v" [0 1 0]
  Shape "disk" "float radius" 2 "float innerradius" .5
AttributeEnd
ObjectBegin "o" Shape "bilinearmesh" "point3 P" [-1 -1 0 1 -1 0 -1 1 0 1 1 1] ObjectEnd
NamedMaterial "m" ObjectInstance "o"
Shape "loopsubdiv" "integer levels" 1 "integer indices" [0 2 4 2 1 4 1 3 4 3 0 4] "point P" [1 0 0 -1 0 0 0 1 0 0 -1 0 0 0 1]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point P" [0 0 0 1 0 0 1 1 0 0 1 0] "float uv" [0 0 1 0 1 1 0 1]
Shape "cylinder" "float zmin" -1 "float zmax" 1 "bool x" "false"
WorldEnd
)";

TEST(Mutants, OfScenesNeverCrash) {
  SceneFolder folder;
  survive({kScene}, [&folder](const std::string& text) {
    const auto scene = folder.parse(text);
    if (!scene.ok()) {
      EXPECT_EQ(message_of(scene.status()).rfind("a.pbrt:", 0), 0u) << message_of(scene.status());
      return;
    }
    needs_of(*scene);
    unsupported(*scene);
    const FolderFiles files = folder.files();
    if (!check_files(*scene, files).ok()) return;
    std::vector<std::string> warnings;
    for (const ShapeEntity& shape : scene->shapes)
      if (has_mesh(shape)) static_cast<void>(make_mesh(shape, *scene, files, warnings));
  });
}

std::string binary_ply(bool big_endian) {
  std::string text = fmt::format(
      "ply\nformat binary_{}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\n"
      "property list uchar short extra\nelement face 2\nproperty list uint8 int vertex_indices\nend_header\n",
      big_endian ? "big" : "little");
  for (int i = 0; i < 3; ++i) text += std::string("\x3f\x80\0\0\0\0\x80\x3f\0\0\0\0\1\1\2", 15);
  for (int i = 0; i < 2; ++i) text += std::string("\3\0\0\0\0\0\0\0\0\0\0\0\0", 13);
  return text;
}

TEST(Mutants, OfMeshesNeverCrash) {
  const std::string ascii =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
      "element face 2\nproperty list uchar uint vertex_indices\nelement edge 1\nproperty int vertex1\n"
      "property int vertex2\nend_header\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n1 1 0 0 0 1 1 1\n0 1 0 0 0 1 0 1\n"
      "4 0 1 2 3\n3 0 1 2\n0 1\n";
  ASSERT_TRUE(read_ply(ascii).ok());
  ASSERT_TRUE(read_ply(binary_ply(false)).ok()) << message_of(read_ply(binary_ply(false)).status());
  ASSERT_TRUE(read_ply(binary_ply(true)).ok());
  survive({ascii, binary_ply(false), binary_ply(true)}, [](const std::string& bytes) {
    const auto ply = read_ply(bytes);
    if (!ply.ok()) return;
    for (const uint32_t index : ply->mesh.indices) ASSERT_LT(index, ply->mesh.positions.size());
  });
}

TEST(Mutants, OfBundleIndicesNeverCrash) {
  const std::string index = serialize(
      {"a.pbrt", {{"a.pbrt", "a.pbrt", Digest(64, 'a'), 3}, {"../t/x", "up1/t/x", Digest(64, '0'), 9}}});
  ASSERT_TRUE(parse_bundle_index(index).ok());
  survive({index}, [](const std::string& text) {
    const auto parsed_index = parse_bundle_index(text);
    if (!parsed_index.ok()) return;
    for (const BundleEntry& entry : parsed_index->entries) {
      EXPECT_EQ(entry.name.find(".."), entry.name.find("..."));
      EXPECT_NE(entry.name[0], '/');
    }
  });
}

}  // namespace
}  // namespace penumbra

#include "scenes/bundle.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "scenes/bundle_names.h"
#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const Digest kDigest(64, 'a');

std::string index_of(std::string_view name) {
  return fmt::format(
      R"({{"entries":[{{"name":"{}","reference":"x","sha256":"{}","size":1}}],"main":"{}","schema":1}})",
      name, kDigest, name);
}

std::string index_error(std::string_view json) {
  const auto index = parse_bundle_index(json);
  EXPECT_FALSE(index.ok()) << json;
  EXPECT_EQ(index.status().code(), absl::StatusCode::kInvalidArgument);
  return message_of(index.status());
}

TEST(Sha256, AgreesWithFips180) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const SceneFolder folder;
  folder.write("f", "abc");
  EXPECT_EQ(*sha256_file(folder.path("f")), sha256("abc"));
  EXPECT_FALSE(sha256_file(folder.path("none")).ok());
}

TEST(BundleNames, StayInsideAndApart) {
  EXPECT_EQ(bundle_name("geometry/a.ply"), "geometry/a.ply");
  EXPECT_EQ(bundle_name("./geo//b/../a.ply"), "geo/a.ply");
  EXPECT_EQ(bundle_name("../textures/x.png"), "up1/textures/x.png");
  EXPECT_EQ(bundle_name("a/../../../x.png"), "up2/x.png");
  EXPECT_EQ(bundle_name("/etc/passwd"), "root/etc/passwd");
  EXPECT_EQ(bundle_name("up1/textures/x.png"), "in/up1/textures/x.png");
  EXPECT_EQ(bundle_name("root/x"), "in/root/x");
  EXPECT_EQ(bundle_name("update/x"), "update/x");
  EXPECT_EQ(bundle_name("textures\\x.png"), "textures/x.png");
  for (const char* const hostile :
       {"../../..", "..", "/..", "a/..", ".", "/", "\\..\\..\\x", "../../../../etc/passwd"}) {
    const std::string name = bundle_name(hostile);
    EXPECT_TRUE(name.empty() || check_bundle_name(name).ok()) << hostile << " -> " << name;
  }
}

TEST(BundleIndex, RefusesNamesThatLeave) {
  for (const char* const name :
       {"/etc/passwd", "../x", "a/../x", "a/..", "..", ".", "a/./b", "a//b", "a/", "", "a\\\\b", "a\\u0000b"})
    EXPECT_THAT(index_error(index_of(name)), HasSubstr("bundle index: name")) << name;
  EXPECT_TRUE(parse_bundle_index(index_of("a/..b/c..d/...")).ok());
  EXPECT_FALSE(check_bundle_name("a\xff").ok());
}

TEST(BundleIndex, RefusesWhatIsNoIndex) {
  EXPECT_THAT(index_error(""), HasSubstr("JSON"));
  EXPECT_THAT(index_error("[]"), HasSubstr("JSON"));
  EXPECT_THAT(index_error(std::string(100'000, '[')), HasSubstr("JSON"));
  EXPECT_THAT(index_error(R"({"schema":1,"main":"a"})"), HasSubstr("entries"));
  EXPECT_THAT(index_error(R"({"schema":2,"main":"a","entries":[]})"), HasSubstr("schema"));
  EXPECT_THAT(index_error(R"({"schema":1,"main":"a","entries":[]})"), HasSubstr("main file"));
  EXPECT_THAT(index_error(R"({"schema":1,"main":"a","entries":[7]})"), HasSubstr("no object"));
  EXPECT_THAT(index_error(R"({"schema":1,"main":"a","entries":[{"name":"a"}]})"), HasSubstr("needs name"));
  const std::string entry = fmt::format(R"({{"name":"a","reference":"a","sha256":"{}","size":1}})", kDigest);
  EXPECT_THAT(index_error(fmt::format(R"({{"schema":1,"main":"a","entries":[{0},{0}]}})", entry)),
              HasSubstr("repeated"));
  EXPECT_THAT(
      index_error(
          R"({"schema":1,"main":"a","entries":[{"name":"a","reference":"a","sha256":"AB","size":1}]})"),
      HasSubstr("SHA-256"));
  EXPECT_THAT(
      index_error(fmt::format(
          R"({{"schema":1,"main":"a","entries":[{{"name":"a","reference":"a","sha256":"{}","size":-1}}]}})",
          kDigest)),
      HasSubstr("size"));
  EXPECT_THAT(
      index_error(fmt::format(
          R"({{"schema":1,"main":"a","entries":[{{"name":"a","reference":"a","sha256":"{}","size":9e18}}]}})",
          kDigest)),
      HasSubstr("size"));
}

TEST(BundleIndex, RoundTripsToTheSameText) {
  const BundleIndex index{
      "a.pbrt", {{"a.pbrt", "a.pbrt", kDigest, 3}, {"../t/x.png", "up1/t/x.png", Digest(64, '0'), 1u << 31}}};
  const auto back = parse_bundle_index(serialize(index));
  ASSERT_TRUE(back.ok()) << message_of(back.status());
  EXPECT_EQ(*back, index);
  EXPECT_EQ(serialize(*back), serialize(index));
}

TEST(Bundle, HoldsWhatTheSceneNamesAndIsReadBack) {
  SceneFolder folder;
  folder.write("scene/a.pbrt",
               "Film \"image\" \"string filename\" \"a.exr\" Include \"inc/b.pbrt\" WorldBegin "
               "Texture \"t\" \"color\" \"imagemap\" \"string filename\" \"../textures/x.png\" "
               "Texture \"u\" \"color\" \"imagemap\" \"string filename\" \"missing.png\" "
               "Material \"metal\" \"spectrum k\" \"spds/k.spd\" \"spectrum eta\" \"metal-Cu-eta\" "
               "LightSource \"infinite\" \"string mapname\" \"./sky.exr\" "
               "Shape \"plymesh\" \"string filename\" \"m.ply\"");
  for (const char* const name : {"scene/inc/b.pbrt", "textures/x.png", "scene/spds/k.spd", "scene/sky.exr",
                                 "scene/m.ply", "scene/a.exr"})
    folder.write(name, fmt::format("# {}", name));
  const std::string main = folder.path("scene/a.pbrt");
  const auto scene = parse_scene_file(main);
  ASSERT_TRUE(scene.ok()) << message_of(scene.status());
  const auto bundle = make_bundle(main, *scene);
  ASSERT_TRUE(bundle.ok()) << message_of(bundle.status());
  std::vector<std::string> names;
  for (const BundleEntry& entry : bundle->index.entries) names.push_back(entry.name);
  EXPECT_THAT(names,
              ElementsAre("a.pbrt", "inc/b.pbrt", "m.ply", "sky.exr", "spds/k.spd", "up1/textures/x.png"));
  EXPECT_EQ(bundle->index.main, "a.pbrt");

  const std::string cache = folder.path("cache");
  for (size_t i = 0; i < names.size(); ++i) {
    const Digest& digest = bundle->index.entries[i].digest;
    const auto target = std::filesystem::path(cache) / digest.substr(0, 2) / digest;
    std::filesystem::create_directories(target.parent_path());
    std::filesystem::copy_file(bundle->paths[i], target);
    EXPECT_EQ(bundle->index.entries[i].size, std::filesystem::file_size(target));
  }
  const auto index = parse_bundle_index(serialize(bundle->index));
  ASSERT_TRUE(index.ok()) << message_of(index.status());
  const BundleFiles files(*index, cache);
  EXPECT_TRUE(parse_scene(index->main, files).ok());
  EXPECT_TRUE(std::filesystem::exists(*files.path_of("../textures/x.png")));
  EXPECT_EQ(files.path_of("missing.png").status().code(), absl::StatusCode::kNotFound);
  EXPECT_FALSE(files.path_of("up1/textures/x.png").ok());  // a folder up1 beside the scene is another one
}

TEST(Bundle, AMissingMeshIsAnError) {
  SceneFolder folder;
  const auto scene = folder.parse("WorldBegin\n Shape \"plymesh\" \"string filename\" \"m.ply\"");
  ASSERT_TRUE(scene.ok());
  EXPECT_THAT(message_of(make_bundle(folder.path("a.pbrt"), *scene).status()),
              testing::StartsWith("a.pbrt:2:18: 'm.ply'"));
}

TEST(Bundle, TwoFilesUnderOneNameAreAnError) {
  SceneFolder folder;
  folder.write("elsewhere/sub/x", "");
  folder.write("elsewhere/m.ply", "1");
  folder.write("m.ply", "2");
  std::filesystem::create_directory_symlink(folder.path("elsewhere/sub"), folder.path("link"));
  const auto scene = folder.parse(
      "WorldBegin Shape \"plymesh\" \"string filename\" \"m.ply\" "
      "Shape \"plymesh\" \"string filename\" \"link/../m.ply\"");
  ASSERT_TRUE(scene.ok());
  EXPECT_THAT(message_of(make_bundle(folder.path("a.pbrt"), *scene).status()),
              HasSubstr("one name in a bundle"));
}

}  // namespace
}  // namespace penumbra

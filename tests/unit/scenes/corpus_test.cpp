// Real files: the parser corpus, the scenes of the manifest, odd PLYs. Found in PENUMBRA_SCENES_DIR.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <sstream>

#include "scenes/check.h"
#include "scenes/mesh.h"
#include "scenes/needs.h"
#include "scenes/ply.h"
#include "scenes/read_file.h"
#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

const char* scenes_dir() {
  return std::getenv("PENUMBRA_SCENES_DIR");
}

std::vector<std::vector<std::string>> read_table(const fs::path& path) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);  // the heads of the columns
  while (std::getline(file, line)) {
    std::vector<std::string> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, '\t');) row.push_back(cell);
    rows.push_back(std::move(row));
  }
  return rows;
}

/// The corpus tests syntax: of most of its files the includes are not there. pbrt-v3 reports a missing
/// include and reads on; so does this, with an empty text in its place.
class FilesOrNothing final : public SceneFiles {
 public:
  explicit FilesOrNothing(std::string folder) : files_(std::move(folder)) { nothing_.write("nothing", ""); }
  absl::StatusOr<std::string> path_of(std::string_view name) const override {
    const auto path = files_.path_of(name);
    return path.ok() ? path : nothing_.path("nothing");
  }

 private:
  FolderFiles files_;
  SceneFolder nothing_;
};

TEST(Corpus, ParsesWherePbrtDoesAndFailsWherePbrtFails) {
  if (!scenes_dir()) GTEST_SKIP() << "PENUMBRA_SCENES_DIR is not set";
  const fs::path corpus = fs::path(scenes_dir()) / "parser-corpus";
  int accepted = 0, refused = 0;
  for (const auto& row : read_table(corpus / "EXPECTED.tsv")) {
    const fs::path path = corpus / row.at(0);
    const auto scene = parse_scene(path.filename().string(), FilesOrNothing(path.parent_path().string()));
    const std::string message = scene.ok() ? "" : message_of(scene.status());
    ASSERT_EQ(scene.ok(), row.at(1) == "yes") << row[0] << ": " << message;
    if (scene.ok()) {
      ++accepted;
      continue;
    }
    ++refused;
    std::smatch expected, found;
    ASSERT_TRUE(std::regex_search(row.at(2), expected, std::regex(R"(\((\d+)\))")));
    ASSERT_TRUE(std::regex_search(message, found, std::regex(R"(:(\d+):\d+: )"))) << message;
    EXPECT_NEAR(std::stoi(found[1]), std::stoi(expected[1]), 2) << message;
  }
  EXPECT_EQ(accepted, 149);
  EXPECT_EQ(refused, 33);
}

absl::Status load(const fs::path& path) {
  const FolderFiles files(path.parent_path().string());
  ASSIGN_OR_RETURN(const SceneDescription scene, parse_scene(path.filename().string(), files));
  RETURN_IF_ERROR(check_files(scene, files));
  needs_of(scene);
  unsupported(scene);
  std::vector<std::string> warnings;
  const auto make_all = [&](const std::vector<ShapeEntity>& shapes) -> absl::Status {
    for (const ShapeEntity& shape : shapes)
      if (has_mesh(shape)) RETURN_IF_ERROR(make_mesh(shape, scene, files, warnings).status());
    return absl::OkStatus();
  };
  RETURN_IF_ERROR(make_all(scene.shapes));
  for (const ObjectEntity& object : scene.objects) RETURN_IF_ERROR(make_all(object.shapes));
  return absl::OkStatus();
}

TEST(Manifest, EverySceneLoads) {
  if (!scenes_dir()) GTEST_SKIP() << "PENUMBRA_SCENES_DIR is not set";
  for (const auto& row : read_table(fs::path(scenes_dir()) / "MANIFEST.tsv")) {
    const absl::Status status = load(fs::path(scenes_dir()) / row.at(2));
    // The manifest tells which files are not there; of those a mesh or an include is an error.
    const std::string& missing = row.at(7);
    const bool lacks_geometry =
        missing.find(".pl") != std::string::npos || missing.ends_with("killeroo.pbrt");
    const bool names_what_is_missing = message_of(status).find("no such file") != std::string::npos;
    EXPECT_TRUE(status.ok() || (lacks_geometry && names_what_is_missing))
        << row[2] << ": " << message_of(status);
  }
}

TEST(OddPly, EverySampleIsRead) {
  if (!scenes_dir()) GTEST_SKIP() << "PENUMBRA_SCENES_DIR is not set";
  int read = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(scenes_dir()) / "odd-ply")) {
    if (entry.path().extension() != ".ply") continue;
    const auto bytes = read_file(entry.path().string());
    ASSERT_TRUE(bytes.ok());
    const auto ply = read_ply(*bytes);
    ASSERT_TRUE(ply.ok()) << entry.path() << ": " << message_of(ply.status());
    EXPECT_GT(ply->mesh.triangles(), 0u) << entry.path();
    ++read;
  }
  EXPECT_GE(read, 13);
}

}  // namespace
}  // namespace penumbra

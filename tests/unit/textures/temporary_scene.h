#pragma once
// A folder of its own with a scene file in it, read by the real parser.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "scenes/files.h"
#include "scenes/parser.h"

namespace penumbra {

class TemporaryScene {
 public:
  TemporaryScene() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        std::filesystem::path(testing::TempDir()) / ("penumbra_" + std::string(test->test_suite_name()) +
                                                     "_" + test->name() + "_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~TemporaryScene() { std::filesystem::remove_all(folder_); }
  TemporaryScene(const TemporaryScene&) = delete;
  TemporaryScene& operator=(const TemporaryScene&) = delete;

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  FolderFiles files() const { return FolderFiles(folder_.string()); }

  /// Parses what stands between WorldBegin and the end.
  SceneDescription parse(const std::string& world) const {
    write("scene.pbrt", "WorldBegin\n" + world);
    auto description = parse_scene_file(path("scene.pbrt"));
    EXPECT_TRUE(description.ok()) << description.status();
    return description.ok() ? *std::move(description) : SceneDescription{};
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace penumbra

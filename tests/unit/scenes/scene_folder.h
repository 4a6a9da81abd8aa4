#pragma once
// A scratch folder with scene files in it; gone with the test.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "proto/status.h"
#include "scenes/files.h"
#include "scenes/parser.h"

namespace penumbra {

class SceneFolder {
 public:
  SceneFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "penumbra-scenes-XXXXXX").string();
    PENUMBRA_CHECK(::mkdtemp(pattern.data()) != nullptr);
    path_ = pattern;
  }
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;
  ~SceneFolder() { std::filesystem::remove_all(path_); }

  std::string path(std::string_view name) const { return (path_ / name).string(); }
  void write(std::string_view name, std::string_view bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  FolderFiles files() const { return FolderFiles(path_.string()); }

  /// Parses the text as a.pbrt.
  absl::StatusOr<SceneDescription> parse(std::string_view text) const {
    write("a.pbrt", text);
    return parse_scene("a.pbrt", files());
  }

 private:
  std::filesystem::path path_;
};

/// The description of a text that must parse.
inline SceneDescription parsed(std::string_view text) {
  auto description = SceneFolder().parse(text);
  EXPECT_TRUE(description.ok()) << message_of(description.status());
  return description.ok() ? *std::move(description) : SceneDescription();
}

/// The error of a text that must not.
inline std::string error_of(std::string_view text) {
  const auto description = SceneFolder().parse(text);
  EXPECT_FALSE(description.ok()) << text;
  EXPECT_EQ(description.status().code(), absl::StatusCode::kInvalidArgument);
  return message_of(description.status());
}

}  // namespace penumbra

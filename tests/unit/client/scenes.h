#pragma once
// Descriptions from lines of text, for tests.
#include <unistd.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "proto/status.h"
#include "scenes/parser.h"

namespace penumbra {

/// The description of `text` as the file s.pbrt in a folder of its own.
inline SceneDescription parsed(const std::string& text) {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("penumbra_client_scene_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto path = folder / "s.pbrt";
  std::ofstream(path) << text;
  auto scene = parse_scene_file(path);
  std::filesystem::remove_all(folder);
  EXPECT_TRUE(scene.ok()) << message_of(scene.status());
  return scene.ok() ? *std::move(scene) : SceneDescription();
}

}  // namespace penumbra

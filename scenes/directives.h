#pragma once
// The table of pbrt's directives: what each one reads, where it may stand, what it means.
#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene_builder.h"

namespace penumbra {

/// One directive with everything that it read.
struct Statement {
  FileLoc loc;
  std::vector<double> numbers;
  std::vector<std::string> strings;
  Params params;

  Vec3d vector(size_t first) const { return {numbers[first], numbers[first + 1], numbers[first + 2]}; }
  /// strings[k] as the plugin name.
  Entity entity(size_t k = 0) { return {std::move(strings[k]), std::move(params), loc}; }
};

struct Directive {
  enum class Place { kAnywhere, kBeforeWorld, kInWorld };
  std::string_view name;
  Place place;
  int numbers;           ///< exactly, with or without brackets
  int strings;           ///< at least
  int optional_strings;  ///< that many more
  bool params;
  absl::Status (*apply)(SceneBuilder&, Statement&);
};

/// Null for a word that is no directive. Include and Import are not among them: they concern the text.
const Directive* find_directive(std::string_view name);

}  // namespace penumbra

#pragma once
#include <string>

#include "absl/status/statusor.h"
#include "tests/bench/geometry/line_workload.h"

namespace penumbra::bench {

/// Meshes, instances, perspective camera and quad lights of a pbrt scene. InvalidArgument if it cannot be
/// read or has no quad light.
absl::StatusOr<BenchScene> load_bench_scene(const std::string& path);

}  // namespace penumbra::bench

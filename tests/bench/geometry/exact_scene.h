#pragma once
// Line queries of a scene against every triangle in extended precision.
#include "tests/bench/geometry/line_workload.h"

namespace penumbra::bench {

struct Exactness {
  size_t chords = 0, partly = 0;  ///< asked; of these partly visible
  size_t doubtful = 0;   ///< chords with a triangle whose combinatorics single precision may get wrong
  size_t wrong = 0;      ///< an end is farther from where it is than the battery's 16 eps (1 + cond)
  double triangles = 0;  ///< that a chord was held against, on average
};

/// Chords of tile_coherent_points(), one each. They come in clusters of up to 256 neighbours; a cluster is
/// held against every triangle whose bounds meet the bounds of all its points and chords: no other can hide
/// any of them. Scenes without instances.
Exactness compare_with_all(const Geometry& geometry, const BenchScene& scene, size_t chords, uint32_t seed);

}  // namespace penumbra::bench

#pragma once
// Renders a scene in this process, tile by tile, and merges as the assembler does: for tests that judge
// pictures, not processes.
#include <string>
#include <vector>

#include "film/film_image.h"
#include "proto/job.h"
#include "worker/render/renderer.h"

namespace penumbra::test {

/// A job over the whole image with the given mixes (labels) and passes.
JobSpec job(int width, int height, const std::vector<std::string>& mixes, int64_t passes);

struct Rendered {
  std::vector<FilmImage> images;  ///< one per mix
  std::vector<MixCost> costs;
  std::vector<std::vector<FilmImage>> bins;  ///< of each mix, of a job with Transient
};

/// Renders all tiles on two threads; groups of `group` passes. Of a mix `auto`, each tile takes the next
/// candidate.
Rendered render(const Scene& scene, const JobSpec& job, int64_t group = 1);

/// Loads a scene file; a failure fails the test and returns null.
ScenePtr load(const std::string& path);
/// Loads a scene from its text, with files beside `folder`.
ScenePtr load_text(const std::string& text);

}  // namespace penumbra::test

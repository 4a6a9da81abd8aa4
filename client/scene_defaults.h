#pragma once
// What a scene asks of a run: resolution, crop, samples, depth, mix. The command line overrides it.
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/parse_text.h"
#include "proto/job.h"
#include "scenes/description.h"

namespace penumbra {

struct SceneDefaults {
  int width = 0, height = 0;
  int64_t passes = 0;              ///< the Sampler's samples per pixel
  int max_depth = 1;               ///< the Integrator's "maxdepth"
  std::optional<Mix> mix;          ///< of Integrator "pointline"
  std::vector<std::string> notes;  ///< what could not be taken as it is, `file:line:column: …`

  /// The Film's crop for an image of this size (the scene's own, or that of --resolution).
  /// InvalidArgument (`file:line:column: …`) if no pixel is left.
  absl::StatusOr<PixelRect> crop(int full_width, int full_height) const;

  std::string film_place;                            ///< of the Film directive, for messages
  std::optional<std::array<double, 4>> crop_window;  ///< x0 x1 y0 y1 as fractions (pbrt-v3)
  std::optional<PixelRect> pixel_bounds;             ///< of the scene's own resolution (pbrt-v4)
};

/// InvalidArgument (`file:line:column: …`) for a resolution, a sample count or a pointline parameter out
/// of range.
absl::StatusOr<SceneDefaults> scene_defaults(const SceneDescription& scene);

}  // namespace penumbra

#include "client/checkpoint_errors.h"

#include "film/metrics.h"
#include "film/own_error.h"

namespace penumbra {

void CheckpointErrors::add(const RunSummary& summary, int mix, int checkpoint, const FilmImage& image,
                           const std::optional<FilmImage>& reference) {
  if (mix < 0 || checkpoint < 0) return;
  const auto m = static_cast<size_t>(mix), c = static_cast<size_t>(checkpoint);
  if (m >= summary.mixes.size() || c >= summary.mixes[m].checkpoints.size()) return;
  const std::vector<Checkpoint>& points = summary.mixes[m].checkpoints;
  std::vector<CheckpointError>& errors = errors_[m];
  errors.resize(points.size());
  if (reference) {
    const absl::StatusOr<ErrorFigures> figures = compare(image, *reference);
    if (!figures.ok()) return;
    errors[c].relmse = figures->relmse;
    errors[c].relmse_ci = figures->relmse_ci;
    return;
  }
  Latest& latest = latest_[m];
  if (c == latest.checkpoint + 1 && !latest.image.rgb.empty()) {
    const auto own = own_error(latest.image, points[c - 1].passes, image, points[c].passes);
    if (own) {
      errors[c - 1].estimated_relmse = own->relmse;
      errors[c - 1].estimated_relmse_ci = own->relmse_ci;
    }
  }
  latest.checkpoint = c;
  latest.image = {image.width, image.height, image.window, image.rgb, {}, {}, {}};
}

std::vector<CheckpointError> CheckpointErrors::of(size_t mix) const {
  const auto found = errors_.find(mix);
  return found == errors_.end() ? std::vector<CheckpointError>() : found->second;
}

}  // namespace penumbra

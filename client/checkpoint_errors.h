#pragma once
// Error against time: what the images at a run's checkpoints are off by.
#include <map>
#include <optional>
#include <vector>

#include "film/film_image.h"
#include "film/statistics.h"
#include "proto/run.h"

namespace penumbra {

/// One point of a mix's timeline. Nothing where it cannot be known.
struct CheckpointError {
  std::optional<double> relmse;  ///< against the reference
  std::optional<ConfidenceInterval> relmse_ci;
  std::optional<double> estimated_relmse;  ///< film/own_error.h
  std::optional<ConfidenceInterval> estimated_relmse_ci;
};

/// Takes the images of a run's checkpoints as they come: those of one mix in order, mixes in any.
class CheckpointErrors {
 public:
  /// The image of mix `mix` at checkpoint `checkpoint` of `summary`; repeated ones replace. With a
  /// reference each image is compared to it; without one, to the next image of the same mix (so the last
  /// one has no estimate here: its variance layer knows better). An index that the summary does not have
  /// (the last image of a run cut short) is passed over.
  void add(const RunSummary& summary, int mix, int checkpoint, const FilmImage& image,
           const std::optional<FilmImage>& reference);
  /// Parallel to MixSummary::checkpoints; may be shorter.
  std::vector<CheckpointError> of(size_t mix) const;

 private:
  struct Latest {
    size_t checkpoint = 0;
    FilmImage image;  ///< R G B alone
  };
  std::map<size_t, std::vector<CheckpointError>> errors_;
  std::map<size_t, Latest> latest_;
};

}  // namespace penumbra

#pragma once
// Frames as they come over the wire, put together again.
#include <array>
#include <map>
#include <optional>

#include "absl/status/statusor.h"
#include "film/film_image.h"
#include "proto/render.pb.h"
#include "proto/run.h"

namespace penumbra {

struct ArrivedFrame {
  int mix = 0, checkpoint = 0;
  int bin = 0;         ///< 0: the picture, else the bin's number + 1
  bool final = false;  ///< has variance, and a picture has samples and cost
  FilmImage image;
};

/// Collects chunks until a frame is whole. DataLoss for chunks that do not fit together.
class FrameAssembler {
 public:
  explicit FrameAssembler(const JobSpec& spec) : spec_(spec) {}
  /// The frame that this chunk completes, if it does.
  absl::StatusOr<std::optional<ArrivedFrame>> add(const v1::FrameChunk& chunk);
  /// Frames begun and not complete.
  size_t pending() const { return growing_.size(); }

 private:
  struct Growing {
    ArrivedFrame frame;
    int64_t pixels = 0;  ///< arrived
  };
  Growing begin(const v1::FrameChunk& chunk) const;

  JobSpec spec_;
  std::map<std::array<int, 3>, Growing> growing_;  ///< by (mix, checkpoint, bin)
};

}  // namespace penumbra

#pragma once
// Merges tile results into frames, always in the order of task ids: the frames' bits depend on which
// results there are, never on when they came or who made them.
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "film/film_image.h"
#include "film/tile_pixels.h"
#include "proto/blob_folder.h"
#include "server/job_record.h"

namespace penumbra {

/// What is needed of a job, copied so that assembling does not hold up the scheduler.
struct Assembly {
  JobSpec spec;
  std::vector<PixelRect> tiles;
  std::optional<Plan> plan;
  uint64_t first_run_id = 0;
  std::vector<Digest> results;  ///< of the run tasks, in order of ids; empty: not accepted yet
  int bins = 0;                 ///< of each mix that are wanted beside its picture: the job's, or none
};
Assembly assembly_of(const JobRecord& job);

/// The cumulative frame of one mix, or of one of its bins.
struct AssembledFrame {
  int mix = 0;
  std::optional<int> bin;  ///< none: the picture
  int checkpoint = 0;      ///< place among the plan's checkpoints; -1 for the last frame of an unfinished job
  bool final = false;      ///< holds everything that was accepted
  FilmImage image;
};

using DeliverFrame = std::function<absl::Status(const AssembledFrame&)>;

/// Delivers each mix's final frame and, if asked for, before it the frames at the checkpoints that every
/// tile has reached; after it those of its bins, final only. Frames are assembled together as far as they fit
/// into `memory` bytes (at least one); results are read once per such batch. Stops at the first error of
/// `deliver`, or of a blob.
absl::Status assemble(const Assembly& job, const BlobFolder& blobs, bool checkpoints, uint64_t memory,
                      const DeliverFrame& deliver);

/// Results whose bytes are gone or no longer what they were, by their place in `results`. Reads them all:
/// for when assembling has failed with NotFound or DataLoss.
std::vector<std::pair<uint64_t, Digest>> lost_results(const Assembly& job, const BlobFolder& blobs);

}  // namespace penumbra

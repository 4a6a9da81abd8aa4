#include "server/assembler.h"

#include <algorithm>
#include <span>

#include "film/frame.h"
#include "proto/status.h"

namespace penumbra {
namespace {

// film/frame.h keeps two means of three doubles, two counts and a cost per pixel.
constexpr uint64_t kBytesPerPixel = (3 + 3 + 1) * sizeof(double) + 2 * sizeof(int64_t);

/// What becomes a frame of its own.
struct Part {
  int mix;
  std::optional<int> bin;
};
using Batch = std::span<const Part>;

std::vector<Part> parts_of(const Assembly& job) {
  std::vector<Part> parts;
  for (int m = 0; m < static_cast<int>(job.spec.mixes.size()); ++m) {
    parts.push_back({m, std::nullopt});
    for (int b = 0; b < job.bins; ++b) parts.push_back({m, b});
  }
  return parts;
}

bool whole_range(const Assembly& job, size_t range) {
  const auto begin = job.results.begin() + static_cast<ptrdiff_t>(range * job.tiles.size());
  return std::none_of(begin, begin + static_cast<ptrdiff_t>(job.tiles.size()),
                      [](const Digest& digest) { return digest.empty(); });
}

absl::Status merge_range(const Assembly& job, const BlobFolder& blobs, size_t range, Batch batch,
                         std::vector<Frame>& frames) {
  for (size_t t = 0; t < job.tiles.size(); ++t) {
    const Digest& digest = job.results[range * job.tiles.size() + t];
    if (digest.empty()) continue;
    ASSIGN_OR_RETURN(std::string bytes, blobs.read(digest));
    ASSIGN_OR_RETURN(const ReceivedTile result, ReceivedTile::parse(std::move(bytes)));
    if (result.mixes().size() != job.spec.mixes.size())
      return make_status(absl::StatusCode::kDataLoss, "result {}: {} mixes", digest, result.mixes().size());
    for (size_t i = 0; i < batch.size(); ++i) {
      const TileView& mix = result.mixes()[static_cast<size_t>(batch[i].mix)];
      if (mix.bins < job.bins)
        return make_status(absl::StatusCode::kDataLoss, "result {}: {} bins", digest, mix.bins);
      merge(frames[i], batch[i].bin ? mix.bin(*batch[i].bin) : mix);
    }
  }
  return absl::OkStatus();
}

absl::Status deliver_frames(const std::vector<Frame>& frames, Batch batch, int checkpoint, bool final,
                            const DeliverFrame& deliver) {
  for (size_t i = 0; i < batch.size(); ++i)
    if (final || !batch[i].bin)
      RETURN_IF_ERROR(deliver({batch[i].mix, batch[i].bin, checkpoint, final,
                               final ? resolve(frames[i]) : resolve_rgb(frames[i])}));
  return absl::OkStatus();
}

absl::Status assemble_batch(const Assembly& job, const BlobFolder& blobs, bool checkpoints, Batch batch,
                            const DeliverFrame& deliver) {
  std::vector<Frame> frames(batch.size(), Frame(job.spec.width, job.spec.height, job.spec.crop));
  const size_t ranges = job.plan ? job.plan->boundaries.size() : 0;
  bool whole = true;
  int checkpoint = -1;
  for (size_t range = 0; range < ranges; ++range) {
    RETURN_IF_ERROR(merge_range(job, blobs, range, batch, frames));
    whole = whole && whole_range(job, range);
    if (!whole || !job.plan->boundaries[range].checkpoint) continue;
    ++checkpoint;
    if (checkpoints && range + 1 < ranges)
      RETURN_IF_ERROR(deliver_frames(frames, batch, checkpoint, false, deliver));
  }
  const bool finished = ranges > 0 && whole;
  return deliver_frames(frames, batch, finished ? checkpoint : -1, true, deliver);
}

}  // namespace

Assembly assembly_of(const JobRecord& job) {
  Assembly out{job.spec(), job.tiles(), job.plan(), job.first_run_id(), {}, 0};
  if (out.spec.transient) out.bins = out.spec.transient->bins;
  for (uint64_t id = job.first_run_id(); id < job.results().size(); ++id)
    out.results.push_back(job.results()[id] ? job.results()[id]->result : Digest());
  return out;
}

absl::Status assemble(const Assembly& job, const BlobFolder& blobs, bool checkpoints, uint64_t memory,
                      const DeliverFrame& deliver) {
  const uint64_t per_frame = static_cast<uint64_t>(job.spec.crop.area()) * kBytesPerPixel;
  const std::vector<Part> parts = parts_of(job);
  const auto together = static_cast<size_t>(std::clamp<uint64_t>(memory / per_frame, 1, parts.size()));
  for (size_t first = 0; first < parts.size(); first += together) {
    const Batch batch = Batch(parts).subspan(first, std::min(together, parts.size() - first));
    RETURN_IF_ERROR(assemble_batch(job, blobs, checkpoints, batch, deliver));
  }
  return absl::OkStatus();
}

std::vector<std::pair<uint64_t, Digest>> lost_results(const Assembly& job, const BlobFolder& blobs) {
  std::vector<std::pair<uint64_t, Digest>> lost;
  for (size_t i = 0; i < job.results.size(); ++i)
    if (!job.results[i].empty() && !blobs.verify(job.results[i]).ok())
      lost.emplace_back(job.first_run_id + i, job.results[i]);
  return lost;
}

}  // namespace penumbra

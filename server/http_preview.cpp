#include "server/http_preview.h"

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "film/own_error.h"
#include "film/png.h"
#include "film/srgb.h"
#include "proto/status.h"
#include "server/assembler.h"
#include "server/job_report.h"

namespace penumbra {
namespace {

constexpr uint64_t kAssemblyBytes = uint64_t{256} << 20;
constexpr double kLeastSeconds = 2, kRestOfCpu = 20, kRestOfWall = 4;
constexpr size_t kMostKept = 16;
constexpr int kWaitSeconds = 2;  // for another's making

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double thread_cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Taken {
  std::vector<MixSummary> mixes;
  Assembly assembly;
  size_t results = 0;
};

/// Where nothing was accepted yet: a shade of its own, so that it is not taken for black.
constexpr uint8_t kUnseen[3] = {43, 50, 66};

bool seen(const FilmImage& image, size_t pixel) {
  return image.samples.empty() || image.samples[pixel] > 0;
}

/// 8-bit codes of linear values: steps of a fifth of a code where the curve is steepest.
constexpr size_t kSteps = 1 << 14;
std::vector<uint8_t> srgb_table() {
  std::vector<uint8_t> table;
  for (size_t i = 0; i <= kSteps; ++i) {
    const double v = static_cast<double>(i) / kSteps;
    table.push_back(static_cast<uint8_t>(std::lround(255 * srgb_encoded(v))));
  }
  return table;
}

uint8_t srgb(double v) {
  static const std::vector<uint8_t> table = srgb_table();
  return v > 0 ? table[static_cast<size_t>(std::min(v, 1.0) * kSteps + 0.5)] : 0;
}

/// The curve of each mix, from its images at checkpoints in order and the final one.
class Curves {
 public:
  explicit Curves(const std::vector<MixSummary>& mixes)
      : mixes_(mixes), curves_(mixes.size()), latest_(mixes.size()) {}

  void add(const AssembledFrame& frame) {
    const auto m = static_cast<size_t>(frame.mix);
    const std::vector<Checkpoint>& points = mixes_[m].checkpoints;
    const auto c = static_cast<size_t>(frame.checkpoint);
    Latest& latest = latest_[m];
    if (frame.checkpoint >= 0 && c < points.size()) {
      if (!latest.image.rgb.empty())
        if (const auto own = own_error(latest.image, latest.at.passes, frame.image, points[c].passes))
          put(m, latest.at, own->relmse);
      if (points[c].passes > latest.at.passes) latest = {points[c], frame.image};
    }
    if (!frame.final) return;
    // Nothing later to compare the latest whole picture with: its own variance speaks for it.
    if (!latest.image.rgb.empty())
      if (const auto own = own_error(latest.image)) put(m, latest.at, own->relmse);
    latest.image = {};
  }
  std::vector<std::vector<CurvePoint>> take() { return std::move(curves_); }

 private:
  struct Latest {
    Checkpoint at;
    FilmImage image;
  };
  void put(size_t mix, const Checkpoint& at, double error) {
    if (at.passes > 0 && error > 0) curves_[mix].push_back({at.passes, at.cpu_seconds, error});
  }

  const std::vector<MixSummary>& mixes_;
  std::vector<std::vector<CurvePoint>> curves_;
  std::vector<Latest> latest_;
};

absl::StatusOr<std::shared_ptr<const Preview>> make(const Taken& taken, const BlobFolder& blobs) {
  auto preview = std::make_shared<Preview>();
  preview->images.resize(taken.mixes.size());
  Curves curves(taken.mixes);
  double exposure = 0;
  RETURN_IF_ERROR(assemble(taken.assembly, blobs, true, kAssemblyBytes, [&](const AssembledFrame& frame) {
    curves.add(frame);
    if (frame.final) {
      if (exposure == 0) exposure = preview_exposure(frame.image);
      preview->images[static_cast<size_t>(frame.mix)] = preview_png(frame.image, exposure);
    }
    return absl::OkStatus();
  }));
  preview->curves = curves.take();
  return preview;
}

}  // namespace

double preview_exposure(const FilmImage& image) {
  std::vector<float> luminance;
  luminance.reserve(image.pixels());
  for (size_t p = 0; p < image.pixels(); ++p) {
    if (!seen(image, p)) continue;
    luminance.push_back(0.2126f * image.rgb[3 * p] + 0.7152f * image.rgb[3 * p + 1] +
                        0.0722f * image.rgb[3 * p + 2]);
  }
  if (luminance.empty()) return 1;
  const auto bright =
      luminance.begin() + static_cast<ptrdiff_t>(0.9 * static_cast<double>(luminance.size() - 1));
  std::nth_element(luminance.begin(), bright, luminance.end());
  return *bright > 0 ? 0.7 / *bright : 1;
}

std::string preview_png(const FilmImage& image, double exposure) {
  const PixelRect& w = image.window;
  const int scale = std::max(1, (std::max(w.width(), w.height()) + kPreviewEdge - 1) / kPreviewEdge);
  const int width = (w.width() + scale - 1) / scale, height = (w.height() + scale - 1) / scale;
  std::vector<uint8_t> bytes;
  bytes.reserve(3 * static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int x1 = std::min((x + 1) * scale, w.width()), y1 = std::min((y + 1) * scale, w.height());
      double sum[3] = {0, 0, 0};
      int count = 0;
      for (int j = y * scale; j < y1; ++j)
        for (int i = x * scale; i < x1; ++i) {
          const size_t p = image.index(w.x0 + i, w.y0 + j);
          if (!seen(image, p)) continue;
          ++count;
          for (size_t c = 0; c < 3; ++c) sum[c] += image.rgb[3 * p + c];
        }
      for (size_t c = 0; c < 3; ++c)
        bytes.push_back(count == 0 ? kUnseen[c] : srgb(exposure * sum[c] / count));
    }
  return png_bytes(width, height, bytes, PngEffort::kQuick);
}

std::shared_ptr<const Preview> Previews::fresh(const JobId& job, double now) {
  const std::lock_guard lock(mutex_);
  const auto kept = kept_.find(job);
  if (kept == kept_.end() || now >= kept->second.not_before) return nullptr;
  kept->second.last_looked_at = now;
  return kept->second.preview;
}

void Previews::keep(const JobId& job, Kept kept) {
  const std::lock_guard lock(mutex_);
  kept_[job] = std::move(kept);
  while (kept_.size() > kMostKept)
    kept_.erase(std::min_element(kept_.begin(), kept_.end(), [](const auto& a, const auto& b) {
      return a.second.last_looked_at < b.second.last_looked_at;
    }));
}

absl::Status Previews::renew(const JobId& job, Kept& kept) {
  ASSIGN_OR_RETURN(const absl::StatusOr<Taken> taken,
                   coordinator_.call([&](Scheduler& scheduler, const Now&) -> absl::StatusOr<Taken> {
                     const JobRecord* record = scheduler.find(job);
                     if (record == nullptr)
                       return make_status(absl::StatusCode::kNotFound, "no job {:.80}", job);
                     Taken out{mix_summaries(*record), assembly_of(*record), 0};
                     out.assembly.bins = 0;  // a page shows pictures
                     for (const Digest& digest : out.assembly.results) out.results += !digest.empty();
                     return out;
                   }));
  RETURN_IF_ERROR(taken.status());
  if (kept.preview && kept.results == taken->results) return absl::OkStatus();
  kept.results = taken->results;
  if (taken->results == 0) {
    kept.preview = std::make_shared<Preview>(Preview{std::vector<std::string>(taken->mixes.size()), {}});
    return absl::OkStatus();
  }
  absl::StatusOr<std::shared_ptr<const Preview>> made = make(*taken, coordinator_.blobs());
  // A result that is gone is no missing job.
  if (!made.ok()) return absl::UnavailableError(made.status().message());
  kept.preview = *std::move(made);
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const Preview>> Previews::of(const JobId& job) {
  if (auto preview = fresh(job, steady_seconds())) return preview;
  Kept kept;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = kept_.find(job); found != kept_.end()) kept = found->second;
  }
  std::unique_lock making(making_, std::defer_lock);
  if (!making.try_lock_for(std::chrono::seconds(kept.preview ? 0 : kWaitSeconds)))
    return kept.preview ? kept.preview : std::make_shared<const Preview>();
  const double begun = steady_seconds();
  if (auto preview = fresh(job, begun)) return preview;  // made while this one waited
  const double cpu = thread_cpu_seconds();
  RETURN_IF_ERROR(renew(job, kept));
  const double end = steady_seconds();
  kept.last_looked_at = begun;
  kept.not_before =
      end + std::max({kLeastSeconds, kRestOfCpu * (thread_cpu_seconds() - cpu), kRestOfWall * (end - begun)});
  std::shared_ptr<const Preview> preview = kept.preview;
  keep(job, std::move(kept));
  return preview;
}

}  // namespace penumbra

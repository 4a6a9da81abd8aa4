#pragma once
// The domain's nouns that cross process borders. Pure data; the wire's messages are converted to these
// in proto/convert.{h,cpp} and nowhere else.
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "proto/mix.h"

namespace penumbra {

/// Pixels [x0,x1) × [y0,y1), y downwards.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool operator==(const PixelRect&) const = default;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  int64_t area() const { return int64_t{width()} * height(); }
};

struct CpuSecondsBudget {
  double seconds = 0;
  bool operator==(const CpuSecondsBudget&) const = default;
};
struct SppBudget {
  int64_t passes = 0;
  bool operator==(const SppBudget&) const = default;
};
struct TargetErrorBudget {
  double relmse = 0;
  bool operator==(const TargetErrorBudget&) const = default;
};
/// What ends a mix: CPU seconds for the whole image summed over cores, camera samples per pixel, or an
/// estimated relMSE.
using Budget = std::variant<CpuSecondsBudget, SppBudget, TargetErrorBudget>;

enum class SamplerKind { kIndependent, kStratified, kSobol };

/// A reply to «which pixels to look at closely».
struct Region {
  std::string name;
  PixelRect rect;
  bool operator==(const Region&) const = default;
};

/// SHA-256, lower-case hexadecimal, 64 characters.
using Digest = std::string;

// What a job may ask for; the client names its flag, the wire its field.
constexpr int kMostTile = 4096;
constexpr int kMostDepth = 1024;
constexpr int kMostCameraGrid = 1024;

/// A job that looks into the estimator instead of making a picture (`converge`).
struct Probe {
  enum class Kind {
    /// The picture's pixels with their camera samples at their centres, every pass an independent group: what
    /// varies between passes is the light samples' own doing.
    kVariance,
    /// One pixel, one light: pixel (i,j) of the frame is the point u = (i + 1/2)/width, v = (j + 1/2)/height
    /// of that light, its value w·f/p of one strategy of the mix.
    kIntegrand,
  };
  Kind kind = Kind::kVariance;
  // For kIntegrand:
  int camera_width = 0, camera_height = 0;  ///< of the camera's image
  int x = 0, y = 0;                         ///< the pixel that is looked at
  int light = 0;                            ///< the area light, in the scene's order
  std::vector<int> slots;                   ///< one per mix: which of its strategies
  bool operator==(const Probe&) const = default;
};

/// What an `auto` mix does in one tile: one of its candidates, and how often.
struct TilePlan {
  int candidate = 0;   ///< place in AutoPlan::candidates
  int64_t passes = 0;  ///< >= 1, of the block with the largest share
  /// Of each block of pixels in the passes (proto/blocks.h), row by row, in 1/kWholeShare; empty: all alike.
  std::vector<uint8_t> shares = {};
  bool operator==(const TilePlan&) const = default;
};

/// The plan of one automatic mix of a job. Names its candidates, so that a stored plan means the same to
/// versions that would try others.
struct AutoPlan {
  int mix = 0;                  ///< the automatic mix's place in JobSpec::mixes
  std::vector<Mix> candidates;  ///< none automatic
  std::vector<TilePlan> tiles;  ///< one per tile of the job, row by row
  bool operator==(const AutoPlan&) const = default;
};

/// What was planned of a run in stages before its present plan took over (server/stages.h). It still decides
/// the passes up to its border.
struct EarlierPlan {
  double until = 0;                         ///< the border, as a share of all passes; in (0,1)
  std::vector<int64_t> passes;              ///< totals as they were planned then: per mix, as JobSpec::plan
  std::vector<std::vector<int64_t>> autos;  ///< of each automatic mix in their order: per tile
  bool operator==(const EarlierPlan&) const = default;
};

/// When light arrives (`--transient`): [t0,t1) of path length, in scene units (light at speed 1, from the
/// camera's vertex to the light), in equal bins. What is longer or shorter is in the picture and in no bin.
struct Transient {
  double t0 = 0, t1 = 0;
  int bins = 0;
  bool operator==(const Transient&) const = default;
  /// Where bin b begins, and bin b − 1 ends.
  double edge(int b) const { return b == bins ? t1 : std::min(t0 + (t1 - t0) * b / bins, t1); }
};
constexpr int kMostBins = 1024;
/// Bins × pixels × mixes: of a tile, which a thread holds while it renders it (72 bytes each), and of the
/// picture, which the client holds until it is written (24 bytes each).
constexpr int64_t kMostTileBins = int64_t{1} << 22, kMostPictureBins = int64_t{1} << 26;

/// Everything that decides a job's pixels, given the bundle's bytes.
struct JobSpec {
  std::string scene;  ///< absolute path on the client's machine, for people
  Digest bundle;      ///< digest of the bundle's index
  std::vector<Mix> mixes;
  Budget budget;
  SamplerKind sampler = SamplerKind::kStratified;
  int width = 0, height = 0;  ///< full image, pixels
  PixelRect crop;             ///< the part that is rendered, absolute pixels
  int max_depth = 1;          ///< vertices with direct light; >1 follows specular chains
  /// > 0: camera samples are moved to the nearest centre of a grid of N × N cells a pixel, so that light
  /// sampling alone is compared with renderers that take theirs there. The image is then the mean over these
  /// points.
  int camera_grid = 0;
  int tile = 64;  ///< edge of a tile, pixels
  uint64_t seed = 0;
  bool strict = false;  ///< warnings about the scene are errors
  /// Passes per mix, fixed (replay); empty: from the budget. Of an automatic mix: the mean over the pixels.
  std::vector<int64_t> plan;
  std::vector<AutoPlan> auto_plans;        ///< with `plan`: one for each automatic mix, in their order
  std::vector<EarlierPlan> earlier_plans;  ///< with `plan`, of a run in stages: borders ascend
  std::string reference;                   ///< path on the client's machine, for people and `fetch`
  std::vector<Region> regions;
  std::optional<Probe> probe;
  /// Effects of the scene (scenes/needs.h) that are not rendered: what they cost is measured against that.
  std::vector<std::string> leave_out;
  std::optional<Transient> transient;
  bool operator==(const JobSpec&) const = default;
};

/// Empty if the job's bins are finite, ascending and not too many, else what is wrong with them.
std::string fault_of_bins(const JobSpec& spec);

/// Passes [begin,end) of one mix.
struct PassRange {
  int64_t begin = 0, end = 0;
  bool operator==(const PassRange&) const = default;
  int64_t count() const { return end - begin; }
};

/// Pilot samples have random numbers of their own and never reach the image.
enum class TaskKind { kPilot, kRun };

/// What stands for an automatic mix of the job in one tile.
struct ChosenMix {
  int mix = 0;                       ///< the automatic mix's place in JobSpec::mixes
  Mix chosen;                        ///< not automatic
  int64_t group = 1;                 ///< passes per independently scrambled group, in place of the task's
  std::vector<uint8_t> shares = {};  ///< TilePlan::shares
  bool operator==(const ChosenMix&) const = default;
};

/// One tile × a range of passes × all mixes that are timed against each other.
struct TileTask {
  uint64_t id = 0;  ///< unique within the job, in merge order
  TaskKind kind = TaskKind::kRun;
  PixelRect tile;
  std::vector<PassRange> passes;  ///< one per mix; may be empty for a mix
  int64_t group = 1;              ///< passes per independently scrambled group (sampling patterns)
  uint64_t shuffle = 0;           ///< seeds the interleaving of the mixes' slices; not the image
  /// kPilot: thread-CPU seconds after which no further pass of a mix is begun (0: all passes).
  double pilot_seconds = 0;
  /// kRun: one for each automatic mix, in their order. kPilot: all candidates of all automatic mixes,
  /// measured on `pilot_blocks` small blocks of pixels (fewer where pilot_seconds per mix are up). Then the
  /// best of them makes the mix's `passes` of the whole tile, as far as as much time again allows.
  std::vector<ChosenMix> chosen;
  int pilot_blocks = 0;
  /// kRun: passes with the pilot's random numbers that are timed between the others and thrown away: what the
  /// pilot's figures are worth by now. One per mix, or none at all.
  std::vector<PassRange> repilot;
  bool operator==(const TileTask&) const = default;
};

/// A fixed piece of work, timed between slices of rendering (worker/render/calibration.h): what a second
/// was worth on that machine then. CPU time in these units compares across machines and moods of one.
struct Calibration {
  uint64_t units = 0;
  double seconds = 0;  ///< thread CPU of all units together; part of no mix's cpu_seconds
  bool operator==(const Calibration&) const = default;
  Calibration& operator+=(const Calibration& other) {
    units += other.units;
    seconds += other.seconds;
    return *this;
  }
};

/// What a pilot has found in a block of pixels (proto/blocks.h): sums over its pixels, of one pass.
struct BlockCost {
  /// s / √(mean² + 1e-2), s² the variance of a pixel summed over channels. Deviations, because few passes
  /// tell their mean far better than that of variances, which a few rare samples may hold most of.
  float relative_deviation = 0;
  float cpu_seconds = 0;
  bool operator==(const BlockCost&) const = default;
};

/// What one mix of one tile task cost. Never part of the image's bits.
struct MixCost {
  int64_t passes = 0;      ///< passes done
  double cpu_seconds = 0;  ///< thread CPU over the tile loop
  uint64_t rays = 0;       ///< camera, specular and shadow rays
  uint64_t line_queries = 0;
  uint64_t non_finite = 0;  ///< samples refused at the film's door
  /// Sum over the tile's pixels and channels of s²/(mean² + 1e-2), s² the variance of one pass; what a
  /// pilot tells `--target-error`. 0 with fewer than two passes.
  double relative_variance = 0;
  Calibration calibration;  ///< timed beside this mix's slices; none in a pilot
  // Of a candidate of `auto`, which a pilot measures on some of the tile's pixels: figures are sums over
  // these.
  int64_t pixels = 0;  ///< measured; `passes` is then the number of passes in each
  /// Sum over the measured pixels of the square of their part of relative_variance: how sure that is.
  double relative_variance_squares = 0;
  int64_t lobed_pixels = 0;  ///< of them, those in which something scatters light into a narrow lobe
  /// Work counted in rays, line queries and their steps, in units of about a nanosecond; the same on every
  /// machine with this instruction set.
  double work = 0;
  double overhead_seconds = 0;  ///< CPU time of the pilot's warming up, in no other figure
  // Of a run task's passes that were thrown away (TileTask::repilot); in no other figure.
  int64_t repilot_passes = 0;
  double repilot_seconds = 0;
  /// Of an automatic mix in a pilot: which of the candidates made whole passes of the tile, and, if there
  /// were at least two, what they found in each block.
  int candidate = 0;
  std::vector<BlockCost> blocks = {};
  bool operator==(const MixCost&) const = default;
};

/// One effect that a scene calls for (design §8), and why.
struct Need {
  std::string effect, why;
  bool operator==(const Need&) const = default;
};

/// What a worker learnt while it loaded a scene.
struct LoadReport {
  double parse_seconds = 0, build_seconds = 0;
  std::vector<Need> needs;
  std::vector<std::string> warnings;
  bool operator==(const LoadReport&) const = default;
};

struct WorkerInfo {
  std::string id, host, isa;  ///< incarnation UUID, host name, widest vector set in use
  int cores = 0;              ///< threads that render
  bool operator==(const WorkerInfo&) const = default;
};

}  // namespace penumbra

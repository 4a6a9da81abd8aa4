#pragma once
// A job's pictures and its error as it falls, from what was accepted so far. Assembled when somebody looks,
// on the viewer's thread, and at most for a twentieth of a core.
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "film/film_image.h"
#include "server/coordinator.h"

namespace penumbra {

/// Longest edge of a preview, pixels; larger images are averaged over blocks.
inline constexpr int kPreviewEdge = 960;

struct CurvePoint {
  int64_t passes = 0;
  double cpu_seconds = 0;
  double estimated_relmse = 0;  ///< film/own_error.h: the server has no reference
};

struct Preview {
  std::vector<std::string> images;              ///< PNG, one per mix; empty: nothing was accepted yet
  std::vector<std::vector<CurvePoint>> curves;  ///< one per mix
};

/// 8-bit sRGB, pixels without samples in a grey of their own; all mixes with the exposure of the first: its
/// 90th percentile of luminance becomes 0.7.
std::string preview_png(const FilmImage& image, double exposure);
/// The factor that does so; 1 for a black image.
double preview_exposure(const FilmImage& image);

class Previews {
 public:
  explicit Previews(Coordinator& coordinator) : coordinator_(coordinator) {}
  /// The latest preview; made again when results have come and twenty times the CPU time of the last making
  /// has passed. NotFound for a job that is not there; an empty one before the first result. While one is
  /// being made, others get the previous one, or after two seconds an empty one.
  absl::StatusOr<std::shared_ptr<const Preview>> of(const JobId& job);

 private:
  struct Kept {
    std::shared_ptr<const Preview> preview;
    size_t results = 0;         ///< accepted when it was made
    double not_before = 0;      ///< steady seconds
    double last_looked_at = 0;  ///< steady seconds
  };
  std::shared_ptr<const Preview> fresh(const JobId& job, double now);
  absl::Status renew(const JobId& job, Kept& kept);
  void keep(const JobId& job, Kept kept);

  Coordinator& coordinator_;
  std::timed_mutex making_;  ///< one is made at a time; taken before mutex_
  std::mutex mutex_;
  std::map<JobId, Kept> kept_;  // guarded by mutex_
};

}  // namespace penumbra

#pragma once
// Variance against light samples: what `converge` asks for and what it makes of the answer. Pure.
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/job_json.h"
#include "film/film_image.h"
#include "film/statistics.h"

namespace penumbra {

/// A mix at one number of light samples.
struct ConvergencePoint {
  int factor = 1;                 ///< every count of the mix times this, a square
  int64_t estimates = 0;          ///< independent ones: passes of the job
  double samples = 0;             ///< light samples per estimate, all strategies together
  double mean = 0, variance = 0;  ///< of one estimate; channels averaged
};

struct ConvergenceCurve {
  std::string mix;  ///< with its own counts
  std::vector<ConvergencePoint> points;
  /// Slope of log variance over log samples; nothing where fewer than three points vary.
  std::optional<PowerLaw> law;
};

/// Squares from 1 over three decades, near equidistant in their logarithm.
std::vector<int> square_factors(int most);

/// The job: every mix of `picture` at every factor, mix-major, at one pixel's centre. More estimates where
/// they are cheap. InvalidArgument where a count grows beyond what a mix may have, for `auto`, or for more
/// mixes than a job may have.
absl::StatusOr<JobSpec> convergence_job(const JobSpec& picture, int x, int y, const std::vector<int>& factors,
                                        int64_t estimates);

/// Reads the job's images, each one pixel.
std::vector<ConvergenceCurve> curves_of(const JobSpec& picture, const JobSpec& job,
                                        const std::vector<int>& factors,
                                        const std::vector<FilmImage>& images);

std::string convergence_text(const std::vector<ConvergenceCurve>& curves);
Json convergence_json(const std::vector<ConvergenceCurve>& curves);
/// Log-log plot as a picture of its own (SVG 1.1, no script).
std::string convergence_svg(const std::vector<ConvergenceCurve>& curves, const std::string& title);

}  // namespace penumbra

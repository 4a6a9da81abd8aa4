#pragma once
// `converge --integrand`: w·f/p of each strategy of each mix over one light, as pictures.
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/job_json.h"
#include "film/film_image.h"

namespace penumbra {

/// One picture of the job.
struct IntegrandPart {
  std::string mix, strategy;  ///< normal forms; strategy without its count
  std::string stem;           ///< of its files
};

/// The job that draws them, `grid` points along each edge of the light, and what each of its mixes draws.
struct IntegrandJob {
  JobSpec spec;
  std::vector<IntegrandPart> parts;
};
/// InvalidArgument for a pixel outside the image, `auto`, or more pictures than a job may have.
absl::StatusOr<IntegrandJob> integrand_job(const JobSpec& picture, int x, int y, int light, int grid);

/// Of a picture: what the strategy expects, and how far from flat it is.
struct IntegrandFigures {
  double mean = 0, largest = 0;
  double lit = 0;        ///< share of the light's area where it is not 0
  double variation = 0;  ///< standard deviation / mean over the light's area; 0 where nothing is lit
};
IntegrandFigures figures_of(const FilmImage& image);

/// False colours from 0 (black) to `largest` (yellow): luminance-ordered, readable without colour. PNG bytes.
std::string integrand_png(const FilmImage& image, double largest);

/// Writes an EXR and a PNG for each part and `integrand.html`, which shows them side by side, in one scale
/// for each mix; answers with the figures.
absl::StatusOr<Json> write_integrands(const IntegrandJob& job, const std::vector<FilmImage>& images,
                                      const std::string& folder);

}  // namespace penumbra

#include "client/convergence.h"

#include <algorithm>
#include <cmath>

#include "proto/status.h"

namespace penumbra {
namespace {

// The wire's limit (proto/convert.cpp); said here in words that fit the command.
constexpr size_t kMostMixes = 256;
// What a mix's grammar takes (proto/mix.cpp).
constexpr int64_t kMostCount = 65536;
// Small counts are cheap: they get up to this many times the estimates.
constexpr int64_t kMostRepeats = 16;
constexpr int kRepeatedBelow = 256;

absl::StatusOr<Mix> scaled(const Mix& mix, int factor) {
  Mix out = mix;
  for (StrategyCount& s : out.strategies) {
    if (int64_t{s.count} * factor > kMostCount)
      return invalid_input("--mix: {} times {} light samples are more than {}", label(mix), factor,
                           kMostCount);
    s.count *= factor;
  }
  return out;
}

}  // namespace

std::vector<int> square_factors(int most) {
  std::vector<int> factors;
  // Edges 1 2 3 4 6 8 11 16 23 32 …: each about √2 times the one before, as far as whole numbers allow.
  for (double edge = 1;; edge *= std::sqrt(2.0)) {
    const auto whole = static_cast<int>(std::lround(edge));
    const int square = whole * whole;
    if (square > most) return factors;
    if (factors.empty() || square > factors.back()) factors.push_back(square);
  }
}

absl::StatusOr<JobSpec> convergence_job(const JobSpec& picture, int x, int y, const std::vector<int>& factors,
                                        int64_t estimates) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height)
    return invalid_input("--pixel: {},{} is not in the image, which is {}x{}", x, y, picture.width,
                         picture.height);
  JobSpec job = picture;
  job.probe = Probe{};
  job.crop = {x, y, x + 1, y + 1};
  job.reference.clear();
  job.regions.clear();
  job.mixes.clear();
  job.plan.clear();
  for (const Mix& mix : picture.mixes) {
    if (mix.automatic) return invalid_input("--mix: auto has no light samples of its own; name a mix");
    for (const int factor : factors) {
      ASSIGN_OR_RETURN(Mix larger, scaled(mix, factor));
      job.mixes.push_back(std::move(larger));
      job.plan.push_back(estimates * std::clamp<int64_t>(kRepeatedBelow / factor, 1, kMostRepeats));
    }
  }
  if (job.mixes.size() > kMostMixes)
    return invalid_input("--mix: {} mixes at {} counts each are more than {}", picture.mixes.size(),
                         factors.size(), kMostMixes);
  job.budget = SppBudget{*std::max_element(job.plan.begin(), job.plan.end())};
  return job;
}

std::vector<ConvergenceCurve> curves_of(const JobSpec& picture, const JobSpec& job,
                                        const std::vector<int>& factors,
                                        const std::vector<FilmImage>& images) {
  PENUMBRA_CHECK(images.size() == picture.mixes.size() * factors.size());
  std::vector<ConvergenceCurve> curves;
  const std::vector<std::string> names = labels(picture.mixes);
  for (size_t m = 0; m < names.size(); ++m) {
    ConvergenceCurve curve{names[m], {}, {}};
    std::vector<double> samples, variances;
    for (size_t f = 0; f < factors.size(); ++f) {
      const size_t i = m * factors.size() + f;
      ConvergencePoint point{factors[f], job.plan[i], static_cast<double>(job.mixes[i].samples()), 0, 0};
      for (size_t c = 0; c < 3; ++c) {
        point.mean += images[i].rgb[c] / 3.0;
        point.variance += images[i].variance[c] * static_cast<double>(point.estimates) / 3;
      }
      if (point.variance > 0) {
        samples.push_back(point.samples);
        variances.push_back(point.variance);
      }
      curve.points.push_back(point);
    }
    curve.law = fit_power_law(samples, variances);
    curves.push_back(std::move(curve));
  }
  return curves;
}

std::string convergence_text(const std::vector<ConvergenceCurve>& curves) {
  size_t width = 3;
  for (const ConvergenceCurve& curve : curves) width = std::max(width, curve.mix.size());
  std::string text = fmt::format("{:{}}  {:>6}  {:17}", "mix", width, "slope", "95 % interval");
  for (const ConvergencePoint& point : curves[0].points) text += fmt::format("  {:>9}", point.factor);
  text += fmt::format("\n{:{}}  {:>6}  {:17}  variance of one estimate, with the counts times\n", "", width,
                      "", "");
  for (const ConvergenceCurve& curve : curves) {
    if (curve.law)
      text += fmt::format("{:{}}  {:>6.2f}  {:17}", curve.mix, width, curve.law->slope,
                          fmt::format("[{:.2f}, {:.2f}]", curve.law->ci.low, curve.law->ci.high));
    else
      text += fmt::format("{:{}}  {:>6}  {:17}", curve.mix, width, "–", "no variance");
    for (const ConvergencePoint& point : curve.points) text += fmt::format("  {:>9.3g}", point.variance);
    text += '\n';
  }
  return text;
}

Json convergence_json(const std::vector<ConvergenceCurve>& curves) {
  Json out = Json::array();
  for (const ConvergenceCurve& curve : curves) {
    Json points = Json::array();
    for (const ConvergencePoint& p : curve.points)
      points.push_back({{"light_samples", p.samples},
                        {"estimates", p.estimates},
                        {"mean", p.mean},
                        {"variance", p.variance}});
    Json mix = {{"mix", curve.mix}, {"points", points}};
    mix["slope"] = curve.law ? Json(curve.law->slope) : Json(nullptr);
    mix["slope_ci"] = curve.law ? Json::array({curve.law->ci.low, curve.law->ci.high}) : Json(nullptr);
    out.push_back(mix);
  }
  return out;
}

}  // namespace penumbra

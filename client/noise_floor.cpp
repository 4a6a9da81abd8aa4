#include "client/noise_floor.h"

#include <cmath>

#include "client/gate_decision.h"
#include "proto/status.h"

namespace penumbra {
namespace {

/// Of values around their own mean.
Spread around_mean(const std::vector<double>& values) {
  const Estimate mean = *mean_of(values);
  return {mean.standard_error * std::sqrt(static_cast<double>(values.size())), mean.degrees_of_freedom};
}

/// Of single values, from differences of pairs that share everything else: E d² = 2 σ².
Spread of_differences(const std::vector<double>& differences) {
  double squares = 0;
  for (const double d : differences) squares += d * d;
  const double n = static_cast<double>(differences.size());
  return {std::sqrt(squares / (2 * n)), n};
}

double percent(double log_sd) {
  return 100 * std::expm1(log_sd);
}

Json spread_json(const Spread& s) {
  return {{"log_sd", s.log_sd},
          {"log_sd_ci", Json::array({s.ci().low, s.ci().high})},
          {"degrees_of_freedom", s.degrees_of_freedom}};
}

}  // namespace

ConfidenceInterval Spread::ci() const {
  // χ²_p ≈ ν (1 - 2/(9ν) + z_p √(2/(9ν)))³ (Wilson & Hilferty 1931).
  const double nu = degrees_of_freedom, c = 2 / (9 * nu);
  const auto chi_square = [&](double p) {
    return nu * std::pow(1 - c + normal_quantile(p) * std::sqrt(c), 3);
  };
  return {log_sd * std::sqrt(nu / chi_square(0.975)), log_sd * std::sqrt(nu / chi_square(0.025))};
}

NoiseFigures noise_of(const std::vector<NullRun>& runs) {
  PENUMBRA_CHECK(runs.size() >= 2);
  std::vector<double> within, error, between, raw;
  NoiseFigures noise;
  for (const NullRun& run : runs) {
    const double log_seconds = 0.5 * std::log(run.seconds_per_pass[0] * run.seconds_per_pass[1]);
    within.push_back(std::log(run.seconds_per_pass[0] / run.seconds_per_pass[1]));
    error.push_back(std::log(run.error_per_pass[0] / run.error_per_pass[1]));
    raw.push_back(log_seconds);
    between.push_back(log_seconds - std::log(run.unit_seconds));
    noise.unit_seconds += run.unit_seconds / static_cast<double>(runs.size());
  }
  noise.cpu_within = of_differences(within);
  noise.error = of_differences(error);
  noise.cpu_between = around_mean(between);
  noise.cpu_raw = around_mean(raw);
  return noise;
}

double found_increase(const Spread& cpu_between, double tolerance) {
  // A gate of one mix judges four figures (error_rows, and this one). Its lower bound must clear the
  // tolerance 19 times of 20.
  constexpr int kFigures = 4;
  const double sd = cpu_between.log_sd * std::sqrt(2.0), alarm = sidak(kFalseAlarms, kFigures);
  const double t = t_quantile(1 - alarm, cpu_between.degrees_of_freedom) - normal_quantile(kMissed);
  return std::exp(std::log1p(tolerance) + t * sd) - 1;
}

std::string noise_text(const NoiseFigures& n) {
  const auto line = [](const char* what, const Spread& s) {
    return fmt::format("{:46} ±{:.2f} %  [{:.2f}, {:.2f}]\n", what, percent(s.log_sd), percent(s.ci().low),
                       percent(s.ci().high));
  };
  constexpr double kTolerance = 0.05;
  return "noise floor (standard deviation, 95 % interval)\n" +
         line("CPU per pass, two mixes of one run", n.cpu_within) +
         line("CPU per pass between runs, calibration units", n.cpu_between) +
         line("CPU per pass between runs, seconds", n.cpu_raw) + line("error per pass of one run", n.error) +
         fmt::format("calibration loop: {:.1f} µs a unit\n", 1e6 * n.unit_seconds) +
         fmt::format(
             "gate --baseline --noise finds an increase of CPU per pass of {:.3g} % (tolerance {:.3g} "
             "%, 19 times of 20)\n",
             100 * found_increase(n.cpu_between, kTolerance), 100 * kTolerance);
}

Json noise_json(const NoiseFigures& n) {
  Json cpu = spread_json(n.cpu_between);
  cpu["within_run"] = spread_json(n.cpu_within);
  cpu["in_seconds"] = spread_json(n.cpu_raw);
  return {{"schema", 1},
          {"version", PENUMBRA_VERSION},
          {"cpu_per_pass", cpu},
          {"error_per_pass", spread_json(n.error)},
          {"calibration", {{"seconds_per_unit", n.unit_seconds}}}};
}

}  // namespace penumbra

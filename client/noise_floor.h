#pragma once
// What `calibrate` makes of its runs. Pure.
#include <string>
#include <vector>

#include "client/job_json.h"
#include "film/statistics.h"

namespace penumbra {

/// One run of the same mix twice, A and A, interleaved.
struct NullRun {
  double seconds_per_pass[2] = {0, 0};
  double error_per_pass[2] = {0, 0};
  double unit_seconds = 0;  ///< of the calibration loop
};

/// A standard deviation of logarithms, with its degrees of freedom.
struct Spread {
  double log_sd = 0;
  double degrees_of_freedom = 0;
  /// 95 %, from χ² (Wilson & Hilferty's approximation).
  ConfidenceInterval ci() const;
};

struct NoiseFigures {
  Spread cpu_within;   ///< CPU per pass between two mixes of one run: what --mix … --mix … compares
  Spread cpu_between;  ///< CPU per pass in calibration units between runs: what gate --baseline compares
  Spread cpu_raw;      ///< the same in seconds: what the calibration loop saves
  Spread error;        ///< error per pass of one mix of one run
  double unit_seconds = 0;
};

/// At least two runs.
NoiseFigures noise_of(const std::vector<NullRun>& runs);

/// The increase of CPU per pass that `gate --baseline --noise` calls worse 19 times of 20.
double found_increase(const Spread& cpu_between, double tolerance);

std::string noise_text(const NoiseFigures& noise);
/// "cpu_per_pass": {"log_sd", "log_sd_ci", "degrees_of_freedom", "within_run", "in_seconds"},
/// "error_per_pass", …
Json noise_json(const NoiseFigures& noise);

}  // namespace penumbra

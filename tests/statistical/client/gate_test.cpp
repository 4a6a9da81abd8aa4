// How often does `gate` raise a false alarm, and how often does it find a true regression? Synthetic runs
// through the product's own path: pixels -> error figures -> run.json -> verdict. Fixed seeds.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "client/gate_run.h"
#include "client/run_json.h"

namespace penumbra {
namespace {

constexpr int kPairs = 500;
constexpr int kEdge = 144, kTile = 48;
constexpr int64_t kPasses = 32;

/// What a synthetic estimator does to one pass of a pixel.
struct Estimator {
  double variance = 1, seconds = 1;  ///< factors
};

/// How noisy the machine is: standard deviations of logarithms.
struct Machine {
  double between_runs = 0.02, between_tiles = 0.02, speed = 1;
};

RunRecord empty_run() {
  RunRecord run;
  JobSpec& spec = run.summary.spec;
  spec.bundle = std::string(64, 'a');
  spec.mixes = {*parse_mix("bsdf:1+line-sa@v:3")};
  spec.budget = SppBudget{kPasses};
  spec.width = spec.height = kEdge;
  spec.crop = {0, 0, kEdge, kEdge};
  run.summary.workers = {{"0123", "host", "avx2", 2}};
  run.mixes.resize(1);
  run.mixes[0].label = label(spec.mixes[0]);
  return run;
}

/// Difficulty (variance) over a decade and a half, and noise with tails: one pixel in 200 is a firefly of
/// three times the spread. relMSE of one run is then sure to 1.8 %, as of an ordinary run of that size.
ErrorFigures render(const Estimator& estimator, std::mt19937& random) {
  FilmImage reference;
  reference.width = reference.height = kEdge;
  reference.window = {0, 0, kEdge, kEdge};
  reference.rgb.assign(3 * reference.pixels(), 0.5f);
  FilmImage image = reference;
  std::normal_distribution<float> normal;
  std::uniform_int_distribution<int> chance(0, 199);
  for (int y = 0; y < kEdge; ++y)
    for (int x = 0; x < kEdge; ++x) {
      const double spread = 0.02 * std::exp(0.5 * (std::sin(x / 20.0) + std::cos(y / 13.0))) *
                            std::sqrt(estimator.variance) * (chance(random) == 0 ? 3 : 1);
      const float noise = normal(random) * static_cast<float>(spread);
      for (size_t c = 0; c < 3; ++c) image.rgb[3 * image.index(x, y) + c] += noise;
    }
  return *compare(image, reference);
}

Json synthetic_run(const Estimator& estimator, const Machine& machine, std::mt19937& random) {
  RunRecord run = empty_run();
  const auto log_normal = [&](double sd) {
    return std::exp(std::normal_distribution<double>(0, sd)(random));
  };
  const double mood = log_normal(machine.between_runs);
  MixSummary mix;
  mix.mix = run.summary.spec.mixes[0];
  mix.passes = mix.planned_passes = kPasses;
  for (int y = 0; y < kEdge; y += kTile)
    for (int x = 0; x < kEdge; x += kTile) {
      TileRow row{{x, y, x + kTile, y + kTile}, 0, kPasses, 0, "0123", {}};
      row.cpu_seconds =
          0.1 * (1 + x / kTile) * machine.speed * estimator.seconds * mood * log_normal(machine.between_tiles);
      row.calibration = {10, 10 * 1e-4 * machine.speed * log_normal(machine.between_tiles / 3)};
      mix.cpu_seconds += row.cpu_seconds;
      mix.calibration += row.calibration;
      run.summary.tiles.push_back(row);
    }
  run.summary.mixes = {mix};
  run.mixes[0].error = render(estimator, random);
  return run_json(run);
}

struct Counts {
  int pass = 0, worse = 0, inconclusive = 0;
};

Counts gate_pairs(const Estimator& now, const Machine& now_machine, unsigned seed,
                  const GateOptions& options = {}, const Machine& base_machine = {}) {
  Counts counts;
  for (unsigned pair = 0; pair < kPairs; ++pair) {
    std::mt19937 random(seed + pair);
    const Json before = synthetic_run({}, base_machine, random);
    const Json after = synthetic_run(now, now_machine, random);
    const auto result = gate_runs(after, "run.json", before, "base.json", options);
    if (!result.ok()) {
      ADD_FAILURE() << result.status();
      return counts;
    }
    counts.pass += result->verdict == Verdict::kPass;
    counts.worse += result->verdict == Verdict::kWorse;
    counts.inconclusive += result->verdict == Verdict::kInconclusive;
  }
  std::printf("pass %d, worse %d, inconclusive %d of %d\n", counts.pass, counts.worse, counts.inconclusive,
              kPairs);
  return counts;
}

TEST(Gate, RaisesFewFalseAlarms) {
  const Counts counts = gate_pairs({}, {}, 1000);
  EXPECT_LE(counts.worse, 5);
}

TEST(Gate, RaisesFewFalseAlarmsOnAnotherMachine) {
  EXPECT_LE(gate_pairs({}, {0.02, 0.02, 1.7}, 2000).worse, 5) << "the calibration loop takes its speed out";
}

TEST(Gate, RaisesFewFalseAlarmsOnANoisyMachineThatIsCalibrated) {
  GateOptions options;
  options.noise = NoiseFloor{0.06, 20};
  EXPECT_LE(gate_pairs({}, {0.06, 0.05, 1}, 3000, options, {0.06, 0.05, 1}).worse, 5);
}

TEST(Gate, FindsATwentyPercentLargerError) {
  EXPECT_GE(gate_pairs({1.2, 1}, {}, 4000).worse, 475);
}

TEST(Gate, FindsTwentyPercentMoreCpu) {
  GateOptions options;
  options.noise = NoiseFloor{0.012, 20};
  EXPECT_GE(gate_pairs({1, 1.2}, {0.01, 0.02, 1}, 5000, options, {0.01, 0.02, 1}).worse, 475);
}

TEST(Gate, ATrueImprovementPasses) {
  GateOptions options;
  options.noise = NoiseFloor{0.012, 20};
  const Counts counts = gate_pairs({0.8, 0.8}, {0.01, 0.02, 1}, 6000, options, {0.01, 0.02, 1});
  EXPECT_GE(counts.pass, 495);
}

TEST(Gate, ARegressionWithinTheToleranceIsNotCalledWorse) {
  EXPECT_LE(gate_pairs({1.04, 1}, {}, 7000).worse, 5);
}

}  // namespace
}  // namespace penumbra

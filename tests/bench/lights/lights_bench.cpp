// What choosing points and lines costs at one shading point: set-up shared by all samples, then per sample.
#include <benchmark/benchmark.h>

#include <vector>

#include "worker/lights/chords.h"
#include "worker/lights/irradiance.h"
#include "worker/lights/line.h"
#include "worker/sampling/hash.h"
#include "worker/sampling/sampler.h"

namespace penumbra {
namespace {

const LightShape kRectangle = QuadShape{{-1, -0.5f, 0}, {2, 0, 0}, {0, 1, 0}};
const LightShape kSkew = QuadShape{{-1, -0.5f, 0}, {2, 0, 0}, {0.7f, 1, 0}};
const LightShape kTriangle = TriangleShape{{-1, -0.5f, 0}, {1, -0.5f, 0}, {0, 1, 0}};
const LightShape kSphere = SphereShape{{0, 0, 0}, 0.5f, false};

/// Shading points all around, so that no branch is foreseen; 1 in 4 has its foot in the rectangle.
std::vector<Vec3d> shading_points() {
  std::vector<Vec3d> points;
  for (uint64_t i = 0; i < 1024; ++i) {
    const double a = uniform(mix64(3 * i + 1)), b = uniform(mix64(3 * i + 2)), c = uniform(mix64(3 * i + 3));
    points.emplace_back(8 * a - 4, 2 * b - 1, 1 + 2 * c);
  }
  return points;
}

Vec2d square(uint64_t i) {
  return {uniform(mix64(2 * i)), uniform(mix64(2 * i + 1))};
}

void seen_shape(benchmark::State& state, const LightShape& shape) {
  const std::vector<Vec3d> x = shading_points();
  uint64_t i = 0;
  for (auto _ : state) {
    const SeenShape seen(shape, x[++i % x.size()]);
    benchmark::DoNotOptimize(seen.solid_angle());
  }
}

/// Set-up and range(0) samples.
void solid_angle_samples(benchmark::State& state, const LightShape& shape) {
  const std::vector<Vec3d> x = shading_points();
  uint64_t i = 0;
  for (auto _ : state) {
    const SeenShape seen(shape, x[++i % x.size()]);
    for (int k = 0; k < state.range(0); ++k) benchmark::DoNotOptimize(seen.sample(square(16 * i + k)));
  }
}

void area_sample(benchmark::State& state, const LightShape& shape) {
  const std::vector<Vec3d> x = shading_points();
  uint64_t i = 0;
  for (auto _ : state) {
    ++i;
    benchmark::DoNotOptimize(sample_area(shape, x[i % x.size()], square(i)));
  }
}

/// Set-up, range(0) lines and a point on each, of which two parts are visible.
void line_solid_angle_samples(benchmark::State& state) {
  const std::vector<Vec3d> x = shading_points();
  const std::vector<Interval> visible = {{0.1f, 0.4f}, {0.6f, 1}};
  uint64_t i = 0;
  for (auto _ : state) {
    const SeenShape seen(kRectangle, x[++i % x.size()]);
    for (int k = 0; k < state.range(0); ++k) {
      const Vec2d u = square(16 * i + k);
      benchmark::DoNotOptimize(
          sample_line(choose_line_solid_angle(seen, false, u.x), seen.x(), visible, u.y));
    }
  }
}

void line_area_samples(benchmark::State& state, const LightShape& shape) {
  const std::vector<Vec3d> x = shading_points();
  const std::vector<Interval> visible = {{0.1f, 0.4f}, {0.6f, 1}};
  const ParallelChords chords(shape, 0.6);
  uint64_t i = 0;
  for (auto _ : state) {
    ++i;
    const Vec2d u = square(i);
    benchmark::DoNotOptimize(sample_line(chords.choose(u.x), x[i % x.size()], visible, u.y));
  }
}

void parallel_chords(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(ParallelChords(kSkew, 0.6));
}

void line_solid_angle_density(benchmark::State& state) {
  const std::vector<Vec3d> x = shading_points();
  const SeenShape seen(kRectangle, x[0]);
  uint64_t i = 0;
  for (auto _ : state) {
    const Vec2d u = square(++i);
    const LightLine line = line_solid_angle_through(seen, false, Vec3d(2 * u.x - 1, u.y - 0.5, 0));
    benchmark::DoNotOptimize(pdf_line(line, seen.x(), u.y, relative_measure(line, 0.1, 0.7)));
  }
}

void unoccluded_irradiance(benchmark::State& state) {
  const std::vector<Vec3d> x = shading_points();
  uint64_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(irradiance(kRectangle, x[++i % x.size()], {0, 0, -1}));
}

void sampler_light(benchmark::State& state, SamplerKind kind) {
  uint64_t i = 0;
  for (auto _ : state) {
    ++i;
    const PassSampler sampler(kind, 1, 0, TaskKind::kRun, static_cast<uint32_t>(i / 4), 5, 8);
    for (int k = 0; k < 4; ++k) benchmark::DoNotOptimize(sampler.light(0, 1, 2, k, 4));
  }
}

BENCHMARK_CAPTURE(seen_shape, rectangle, kRectangle);
BENCHMARK_CAPTURE(seen_shape, skew, kSkew);
BENCHMARK_CAPTURE(seen_shape, triangle, kTriangle);
BENCHMARK_CAPTURE(seen_shape, sphere, kSphere);
BENCHMARK_CAPTURE(solid_angle_samples, rectangle, kRectangle)->Arg(1)->Arg(4);
BENCHMARK_CAPTURE(solid_angle_samples, skew, kSkew)->Arg(1)->Arg(4);
BENCHMARK_CAPTURE(solid_angle_samples, triangle, kTriangle)->Arg(1)->Arg(4);
BENCHMARK_CAPTURE(solid_angle_samples, sphere, kSphere)->Arg(1)->Arg(4);
BENCHMARK_CAPTURE(area_sample, rectangle, kRectangle);
BENCHMARK_CAPTURE(area_sample, sphere, kSphere);
BENCHMARK(line_solid_angle_samples)->Arg(1)->Arg(4);
BENCHMARK_CAPTURE(line_area_samples, rectangle, kRectangle);
BENCHMARK(parallel_chords);
BENCHMARK(line_solid_angle_density);
BENCHMARK(unoccluded_irradiance);
BENCHMARK_CAPTURE(sampler_light, independent_4, SamplerKind::kIndependent);
BENCHMARK_CAPTURE(sampler_light, stratified_4, SamplerKind::kStratified);
BENCHMARK_CAPTURE(sampler_light, sobol_4, SamplerKind::kSobol);

}  // namespace
}  // namespace penumbra

BENCHMARK_MAIN();

#include "tests/bench/geometry/line_timing.h"

#include <time.h>

#include <algorithm>

namespace penumbra::bench {
namespace {

constexpr size_t kChunk = 256;

double thread_cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double>& values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// Keeps results alive: the optimiser may not drop the work.
volatile size_t sink;

/// All lines of a shading point as the renderer asks for them: a shaft first, then the lines together. After
/// n shafts in a row that held too much to list, the next 2^n points do without (strategies: LightSight).
class SharedLines {
 public:
  SharedLines(const Geometry& geometry, const BenchScene& scene)
      : geometry_(geometry), lights_(scene.lights.size()) {
    for (size_t i = 0; i < lights_.size(); ++i) lights_[i].polygon = scene.lights[i].polygon();
  }

  void trace(const ShadingPoint& p, std::vector<IntervalSet>& visible, QueryCounters& counters) {
    Light& light = lights_[p.light];
    if (light.pause > 0) {
      --light.pause;
      return geometry_.visible(p.lines, visible, counters);
    }
    geometry_.enter({p.lines[0].x, &light.polygon, p.normal}, shaft_, counters);
    const bool failed = shaft_.content() == ShaftContent::kMany;
    light.failures = failed ? std::min(light.failures + 1, kLongestPause) : 0;
    light.pause = failed ? 1 << light.failures : 0;
    geometry_.visible(shaft_, p.lines, visible, counters);
  }

 private:
  static constexpr int kLongestPause = 6;
  struct Light {
    LightPolygon polygon;
    int failures = 0, pause = 0;
  };
  const Geometry& geometry_;
  std::vector<Light> lights_;
  Shaft shaft_;
};

class Timer {
 public:
  /// `shared`: how to trace the lines of one point together; null: one call without a shaft.
  Timer(const Geometry& geometry, int repetitions, SharedLines* shared = nullptr)
      : geometry_(geometry), repetitions_(repetitions), shared_(shared) {}

  /// Sums of the chunks' medians, in seconds: rays first, lines second.
  std::pair<double, double> time(const std::vector<ShadingPoint>& points) {
    double rays = 0, lines = 0;
    for (size_t first = 0; first < points.size(); first += kChunk) {
      const std::span<const ShadingPoint> chunk(points.data() + first,
                                                std::min(kChunk, points.size() - first));
      // A class of few points is traced often enough that the clock's own cost does not count.
      const size_t rounds = (kChunk + chunk.size() - 1) / chunk.size();
      std::vector<double> ray_times, line_times;
      trace_rays(chunk), trace_lines(chunk);
      for (int r = 0; r < repetitions_; ++r) {
        const double t0 = thread_cpu_seconds();
        for (size_t i = 0; i < rounds; ++i) trace_rays(chunk);
        const double t1 = thread_cpu_seconds();
        for (size_t i = 0; i < rounds; ++i) trace_lines(chunk);
        const double t2 = thread_cpu_seconds();
        ray_times.push_back((t1 - t0) / static_cast<double>(rounds));
        line_times.push_back((t2 - t1) / static_cast<double>(rounds));
      }
      rays += median(ray_times);
      lines += median(line_times);
    }
    return {rays, lines};
  }

  QueryCounters counters;

 private:
  void trace_rays(std::span<const ShadingPoint> points) {
    size_t hits = 0;
    for (const ShadingPoint& p : points) {
      for (const LightEnd& y : p.points) hits += geometry_.occluded(p.lines[0].x, y, counters);
    }
    sink = hits;
  }
  void trace_lines(std::span<const ShadingPoint> points) {
    size_t intervals = 0;
    for (const ShadingPoint& p : points) {
      if (shared_ != nullptr)
        shared_->trace(p, visible_, counters);
      else
        geometry_.visible(p.lines, visible_, counters);
      for (const IntervalSet& set : visible_) intervals += set.size();
    }
    sink = intervals;
  }

  const Geometry& geometry_;
  int repetitions_;
  SharedLines* shared_;
  std::vector<IntervalSet> visible_;
};

Class class_of(const IntervalSet& visible) {
  // A frame that touches the light's edge takes a rounding of the chord's end; that is still fully visible.
  constexpr float rounding = 1e-5f;
  if (visible.length() <= rounding) return kOccluded;
  return visible.length() >= 1 - rounding ? kVisible : kPartial;
}

}  // namespace

const char* name_of(Class c) {
  constexpr const char* names[] = {"all", "visible", "partial", "occluded"};
  return names[c];
}

LineTiming time_lines(const Geometry& geometry, const BenchScene& scene, size_t queries, int repetitions) {
  LineTiming timing;
  std::vector<ShadingPoint> classes[kClasses];
  classes[kAll] = tile_coherent_points(geometry, scene, queries, 1, 7);
  QueryCounters unused;
  std::vector<IntervalSet> visible;
  for (const ShadingPoint& p : classes[kAll]) {
    geometry.visible(p.lines, visible, unused);
    classes[class_of(visible[0])].push_back(p);
  }
  for (int c = kAll; c < kClasses; ++c) {
    ClassTiming& t = timing.single[c];
    t.queries = classes[c].size();
    if (t.queries == 0) continue;
    Timer timer(geometry, repetitions);
    const auto [rays, lines] = timer.time(classes[c]);
    const auto n = static_cast<double>(t.queries);
    t.ray_ns = rays / n * 1e9;
    t.line_ns = lines / n * 1e9;
    const auto traced = static_cast<double>(timer.counters.line_queries);
    t.nodes = static_cast<double>(timer.counters.nodes_visited) / traced;
    t.triangles = static_cast<double>(timer.counters.triangles_tested) / traced;
  }
  const auto shared = tile_coherent_points(geometry, scene, queries / 4, 4, 11);
  SharedLines shared_lines(geometry, scene);
  const auto [rays, lines] = Timer(geometry, repetitions, &shared_lines).time(shared);
  const double n = 4 * static_cast<double>(shared.size());
  timing.shared_ray_ns = rays / n * 1e9;
  timing.shared_line_ns = lines / n * 1e9;
  return timing;
}

}  // namespace penumbra::bench

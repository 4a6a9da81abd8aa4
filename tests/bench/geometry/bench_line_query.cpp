// bench_line_query --scene FILE [--queries N] [--repetitions N] [--json]: what a line query costs, in shadow
// rays.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <thread>

#include "proto/status.h"
#include "tests/bench/geometry/bench_scene.h"
#include "tests/bench/geometry/line_timing.h"

namespace penumbra::bench {
namespace {

/// A ratio of a class that has no chords is null.
nlohmann::json ratio_or_null(const ClassTiming& timing) {
  return timing.queries == 0 ? nlohmann::json(nullptr) : nlohmann::json(timing.ratio());
}

void print_json(const Geometry& geometry, const LineTiming& timing) {
  nlohmann::json ratio;
  for (int c = 0; c < kClasses; ++c) ratio[name_of(static_cast<Class>(c))] = ratio_or_null(timing.single[c]);
  ratio["shared"] = timing.shared_ratio();
  const nlohmann::json result = {{"ray_ns", timing.single[kAll].ray_ns},
                                 {"line_ns", timing.single[kAll].line_ns},
                                 {"ratio", ratio},
                                 {"bytes_per_triangle", geometry.line_bytes_per_triangle()},
                                 {"build_seconds", geometry.build_times().line_bvh_seconds},
                                 {"embree_build_seconds", geometry.build_times().embree_seconds},
                                 {"isa", geometry.isa()}};
  fmt::print("{}\n", result.dump());
}

void print_table(const Geometry& geometry, const LineTiming& timing) {
  fmt::print("{:<10}{:>9}{:>10}{:>10}{:>8}{:>8}{:>11}\n", "chords", "queries", "ray ns", "line ns", "ratio",
             "nodes", "triangles");
  for (int c = 0; c < kClasses; ++c) {
    const ClassTiming& t = timing.single[c];
    if (t.queries == 0) continue;
    fmt::print("{:<10}{:>9}{:>10.1f}{:>10.1f}{:>8.2f}{:>8.1f}{:>11.1f}\n", name_of(static_cast<Class>(c)),
               t.queries, t.ray_ns, t.line_ns, t.ratio(), t.nodes, t.triangles);
  }
  fmt::print("{:<10}{:>9}{:>10.1f}{:>10.1f}{:>8.2f}\n", "shared", "", timing.shared_ray_ns,
             timing.shared_line_ns, timing.shared_ratio());
  fmt::print("{}, {:.1f} bytes per triangle, built in {:.2f} s (Embree {:.2f} s)\n", geometry.isa(),
             geometry.line_bytes_per_triangle(), geometry.build_times().line_bvh_seconds,
             geometry.build_times().embree_seconds);
}

int run(int argc, char** argv) {
  CLI::App app("Line queries against shadow rays");
  std::string path;
  size_t queries = 20000;
  int repetitions = 5;
  bool json = false;
  app.add_option("--scene", path, "pbrt scene with quad lights")->required();
  app.add_option("--queries", queries, "single lines to time")->check(CLI::Range(256, 10'000'000));
  app.add_option("--repetitions", repetitions, "of which the median counts")->check(CLI::Range(1, 1000));
  app.add_flag("--json", json, "print one JSON object");
  CLI11_PARSE(app, argc, argv);

  const auto scene = load_bench_scene(path);
  if (!scene.ok()) {
    fmt::print(stderr, "{}: {}\n", path, message_of(scene.status()));
    return 2;
  }
  const int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const auto geometry = Geometry::build(scene->inputs(), scene->objects, scene->instances, threads);
  if (!geometry.ok()) {
    fmt::print(stderr, "{}: {}\n", path, message_of(geometry.status()));
    return 2;
  }
  geometry->prepare_lines();
  const LineTiming timing = time_lines(*geometry, *scene, queries, repetitions);
  if (timing.single[kAll].queries == 0) {
    fmt::print(stderr, "{}: the camera sees nothing that faces a quad light\n", path);
    return 2;
  }
  json ? print_json(*geometry, timing) : print_table(*geometry, timing);
  return 0;
}

}  // namespace
}  // namespace penumbra::bench

int main(int argc, char** argv) {
  return penumbra::bench::run(argc, argv);
}

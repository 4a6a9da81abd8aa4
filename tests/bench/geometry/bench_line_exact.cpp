// bench_line_exact --scene FILE [--chords N] [--seed N]: line queries against every triangle in extended
// precision. Exit code 1 if one of them is wrong.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "proto/status.h"
#include "tests/bench/geometry/bench_scene.h"
#include "tests/bench/geometry/exact_scene.h"

int main(int argc, char** argv) {
  using namespace penumbra;
  CLI::App app("Line queries against every triangle in extended precision");
  std::string path;
  size_t chords = 100000;
  uint32_t seed = 1;
  app.add_option("--scene", path, "pbrt scene with quad lights, without instances")->required();
  app.add_option("--chords", chords, "random chords of the lights, seen from camera hits");
  app.add_option("--seed", seed, "of the chords");
  CLI11_PARSE(app, argc, argv);
  const auto scene = bench::load_bench_scene(path);
  if (!scene.ok() || !scene->instances.empty()) {
    fmt::print(stderr, "{}: {}\n", path, scene.ok() ? "it places instances" : message_of(scene.status()));
    return 2;
  }
  const auto geometry = Geometry::build(scene->inputs(), {}, {}, 1);
  if (!geometry.ok()) {
    fmt::print(stderr, "{}: {}\n", path, message_of(geometry.status()));
    return 2;
  }
  const bench::Exactness e = bench::compare_with_all(*geometry, *scene, chords, seed);
  fmt::print(
      "{} chords, {} partly visible, against {:.0f} triangles each: {} wrong, {} with a doubtful triangle\n",
      e.chords, e.partly, e.triangles, e.wrong, e.doubtful);
  return e.wrong == 0 && e.chords > 0 ? 0 : 1;
}

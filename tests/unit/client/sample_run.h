#pragma once
// A small finished run, for tests of everything that is made from one.
#include "client/run_json.h"

namespace penumbra {

inline RunRecord sample_run() {
  RunRecord run;
  JobSpec& spec = run.summary.spec;
  spec.scene = "/scenes/box.pbrt";
  spec.bundle = std::string(64, 'a');
  spec.mixes = {*parse_mix("bsdf:4"), *parse_mix("bsdf:1+line-sa@v:3")};
  spec.budget = CpuSecondsBudget{10};
  spec.width = 32;
  spec.height = 16;
  spec.crop = {0, 0, 32, 16};
  spec.seed = 18446744073709551615u;
  spec.reference = "/scenes/box.exr";
  spec.regions = {{"left", {0, 0, 16, 16}}};
  RunSummary& s = run.summary;
  s.status.state = JobState::kDone;
  s.status.retries = 2;
  s.total_wall_seconds = 12.5;
  s.render_wall_seconds = 11;
  s.load = {0.25, 0.5, {{"textures", "box.pbrt:3:1: imagemap"}}, {"box.pbrt:9:1: cone left out"}};
  s.workers = {{"0123", "host", "avx2", 2}};
  for (const Mix& mix : spec.mixes) {
    MixSummary m;
    m.mix = mix;
    m.planned_passes = m.passes = 64;
    m.cpu_seconds = 9.5;
    m.rays = 1000;
    m.line_queries = is_line(mix.strategies.back().kind) ? 300 : 0;
    m.checkpoints = {{16, 2.5}, {64, 9.5}};
    s.mixes.push_back(m);
  }
  s.tiles = {{{0, 0, 32, 16}, 0, 64, 9.5, "0123"}, {{0, 0, 32, 16}, 1, 64, 9.5, "0123"}};
  run.scheduler_cpu_seconds = 0.125;
  const std::vector<std::string> names = labels(spec.mixes);
  for (size_t i = 0; i < names.size(); ++i) {
    MixRecord record;
    record.label = names[i];
    record.image = file_stem(names[i]) + ".exr";
    ErrorFigures figures;
    figures.region = spec.crop;
    figures.relmse = 0.5;
    figures.relmse_ci = ConfidenceInterval{0.4, 0.6};
    figures.mse = 0.1;
    record.error = figures;
    record.regions = {{"left", figures}};
    record.own_error = OwnError{0.45, ConfidenceInterval{0.35, 0.55}};
    record.checkpoints = {{2.0, ConfidenceInterval{1.5, 2.5}, 1.75, {}},
                          {0.5, record.error->relmse_ci, {}, {}}};
    run.mixes.push_back(record);
  }
  return run;
}

}  // namespace penumbra

#include "tests/support/render.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <thread>

#include "film/frame.h"
#include "proto/auto_plan.h"
#include "scenes/parser.h"

namespace penumbra::test {

JobSpec job(int width, int height, const std::vector<std::string>& mixes, int64_t passes) {
  JobSpec spec;
  spec.width = width;
  spec.height = height;
  spec.crop = {0, 0, width, height};
  spec.budget = SppBudget{passes};
  for (const std::string& text : mixes) spec.mixes.push_back(parse_mix(text).value());
  spec.plan.assign(mixes.size(), passes);
  return spec;
}

Rendered render(const Scene& scene, const JobSpec& job, int64_t group) {
  std::vector<TileTask> tasks;
  for (int y = job.crop.y0; y < job.crop.y1; y += job.tile)
    for (int x = job.crop.x0; x < job.crop.x1; x += job.tile) {
      TileTask task;
      task.id = tasks.size();
      task.tile = {x, y, std::min(x + job.tile, job.crop.x1), std::min(y + job.tile, job.crop.y1)};
      for (int64_t passes : job.plan) task.passes.push_back({0, passes});
      task.group = group;
      task.shuffle = tasks.size();
      for (const int m : automatic_mixes(job.mixes))
        task.chosen.push_back({m, auto_candidates()[tasks.size() % auto_candidates().size()], group});
      tasks.push_back(task);
    }
  std::vector<TaskOutcome> outcomes(tasks.size());
  std::atomic<size_t> next = 0;
  const std::atomic<bool> cancel = false;
  const auto work = [&] {
    for (size_t t; (t = next++) < tasks.size();) outcomes[t] = render_tile(scene, job, tasks[t], cancel);
  };
  std::thread other(work);
  work();
  other.join();

  Rendered out;
  for (size_t m = 0; m < job.mixes.size(); ++m) {
    Frame frame(job.width, job.height, job.crop);
    MixCost cost;
    for (const TaskOutcome& o : outcomes) {
      merge(frame, o.pixels.mixes[m]);
      cost.cpu_seconds += o.costs[m].cpu_seconds;
      cost.rays += o.costs[m].rays;
      cost.line_queries += o.costs[m].line_queries;
      cost.non_finite += o.costs[m].non_finite;
    }
    out.images.push_back(resolve(frame));
    out.costs.push_back(cost);
    out.bins.emplace_back();
    for (int b = 0; job.transient && b < job.transient->bins; ++b) {
      Frame bin(job.width, job.height, job.crop);
      for (const TaskOutcome& o : outcomes) merge(bin, TileView(o.pixels.mixes[m]).bin(b));
      out.bins.back().push_back(resolve(bin));
    }
  }
  return out;
}

ScenePtr load(const std::string& path) {
  const std::filesystem::path p(path);
  LoadReport report;
  auto scene = load_scene(p.filename().string(), FolderFiles(p.parent_path().string()), {2, false}, report);
  EXPECT_TRUE(scene.ok()) << scene.status();
  return scene.ok() ? *std::move(scene) : nullptr;
}

ScenePtr load_text(const std::string& text) {
  const auto folder =
      std::filesystem::temp_directory_path() /
      ("penumbra-test-" + std::to_string(getpid()) + "-" + std::to_string(std::hash<std::string>{}(text)));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "scene.pbrt") << text;
  ScenePtr scene = load((folder / "scene.pbrt").string());
  std::filesystem::remove_all(folder);
  return scene;
}

}  // namespace penumbra::test

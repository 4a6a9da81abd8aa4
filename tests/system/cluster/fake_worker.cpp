// The worker program with a renderer whose pictures are a hash of what a pass depends on, and which takes
// as long as the scene file says: system tests of the cluster need no scene and no Embree.
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <thread>

#include "proto/status.h"
#include "worker/agent/program.h"

namespace penumbra {
namespace {

double hashed(uint64_t seed, uint64_t mix, uint64_t pixel, uint64_t pass) {
  uint64_t z = seed;
  for (const uint64_t word : {mix, pixel, pass}) {
    z = (z ^ word) * 0x9e3779b97f4a7c15u;
    z ^= z >> 29;
  }
  return static_cast<double>(z >> 11) * 0x1p-53;
}

class FakeScene final : public RenderableScene {
 public:
  explicit FakeScene(int milliseconds) : milliseconds_(milliseconds) {}

  TaskOutcome render(const JobSpec& job, const TileTask& task,
                     const std::atomic<bool>& cancel) const override {
    TaskOutcome outcome;
    for (size_t m = 0; m < task.passes.size(); ++m) {
      endless();
      const int64_t passes = task.kind == TaskKind::kPilot ? 2 : task.passes[m].count();
      for (int64_t pass = 0; pass < passes; ++pass) {
        std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds_));
        if (!cancel) continue;
        outcome.cancelled = true;
        return outcome;
      }
      outcome.costs.push_back({passes, 0.001 * static_cast<double>(passes), 1, 1, 0, 1});
      if (task.kind == TaskKind::kRun) outcome.pixels.mixes.push_back(pixels(job, task, m));
    }
    if (task.kind == TaskKind::kPilot)
      for (size_t k = 0; k < task.chosen.size(); ++k) {
        MixCost cost{4, 0.001 + 0.0001 * static_cast<double>(k), 1, 1, 0, 1};
        cost.pixels = 16;
        cost.work = 1;
        outcome.costs.push_back(cost);
      }
    return outcome;
  }
  std::vector<std::string> substitutions(const Mix&) const override { return {"a substitution"}; }

 private:
  /// PENUMBRA_FAKE=endless: computes for ever and does not hear of being cancelled.
  static void endless() {
    const char* mode = std::getenv("PENUMBRA_FAKE");
    while (mode != nullptr && std::string_view(mode) == "endless")
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }

  static TilePixels pixels(const JobSpec& job, const TileTask& task, size_t m) {
    TilePixels out;
    out.rect = task.tile;
    out.passes = task.passes[m].count();
    out.groups = out.passes;
    for (int y = task.tile.y0; y < task.tile.y1; ++y)
      for (int x = task.tile.x0; x < task.tile.x1; ++x) {
        const auto pixel =
            static_cast<uint64_t>(y) * static_cast<uint64_t>(job.width) + static_cast<uint64_t>(x);
        double sum = 0;
        for (int64_t pass = task.passes[m].begin; pass < task.passes[m].end; ++pass)
          sum += hashed(job.seed, m, pixel, static_cast<uint64_t>(pass));
        const auto mean = static_cast<float>(out.passes == 0 ? 0 : sum / static_cast<double>(out.passes));
        out.mean.insert(out.mean.end(), {mean, mean / 2, mean / 4});
        out.m2.insert(out.m2.end(), 3, mean);
        out.cost.push_back(1);
      }
    return out;
  }

  int milliseconds_;
};

/// The main file holds the milliseconds of a pass, or "bad", or "error".
class FakeLoader final : public SceneLoader {
 public:
  absl::StatusOr<std::shared_ptr<const RenderableScene>> load(const std::string& main_name,
                                                              const SceneFiles& files, const LoadOptions&,
                                                              LoadReport& report) const override {
    ASSIGN_OR_RETURN(const std::string path, files.path_of(main_name));
    std::ifstream in(path);
    std::string word;
    in >> word;
    if (word == "bad") return invalid_input("{}:1:1: unknown shape 'qaud'", main_name);
    if (word == "error") return absl::InternalError("the loader went bang");
    report.warnings = {"a warning"};
    return std::make_shared<FakeScene>(std::stoi(word));
  }
};

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  return penumbra::run_worker(argc, argv, penumbra::FakeLoader());
}

#include "worker/render/candidate_pilot.h"

#include <gtest/gtest.h>

#include <atomic>

#include "tests/support/render.h"
#include "worker/render/light_pixels.h"
#include "worker/render/scene.h"

namespace penumbra {
namespace {

/// A lamp so small that a few directions of the material never meet it.
constexpr const char* kSmallLamp = R"(LookAt 0 3 4  0 0 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 4000 4000 4000 ]
Shape "quad" "point o" [ 0 3 0 ] "vector u" [ 0.04 0 0 ] "vector v" [ 0 0 0.04 ] AttributeEnd
Material "matte"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -9 0 -9  -9 0 9  9 0 9  9 0 -9 ]
)";

TEST(CandidatePilot, AMixThatHasMissedTheLightIsNotWithoutNoise) {
  const ScenePtr scene = test::load_text(kSmallLamp);
  ASSERT_TRUE(scene);
  const std::vector<std::string> names = {"bsdf:4", "sa:4", "bsdf:2+sa:2"};
  const JobSpec job = test::job(32, 32, {"auto"}, 4);
  const auto camera = Camera::build(scene->description, job.width, job.height);
  ASSERT_TRUE(camera.ok());
  TileTask task;
  task.kind = TaskKind::kPilot;
  task.tile = job.crop;
  task.pilot_blocks = 1;
  std::vector<ChosenMix> candidates;
  for (const std::string& name : names) candidates.push_back({0, *parse_mix(name)});
  const Rendering rendering{*scene, job, *camera, task.kind, task.tile, light_pixels(*scene, *camera, task.tile)};
  const std::atomic<bool> cancel{false};
  const std::vector<MixCost> costs = measure_candidates(rendering, task, candidates, cancel);
  ASSERT_EQ(costs.size(), 3u);
  EXPECT_GT(costs[0].relative_variance, 100 * costs[1].relative_variance);
  EXPECT_GT(costs[0].relative_variance, 100 * costs[2].relative_variance);
  // What has seen the light is judged by its own scatter alone: a point of this lamp varies little.
  EXPECT_LT(costs[1].relative_variance / double(costs[1].pixels), 0.01);
}

}  // namespace
}  // namespace penumbra

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

std::vector<MixCost> pilot(const Scene& scene, const std::vector<std::string>& names) {
  const JobSpec job = test::job(32, 32, {"auto"}, 4);
  const auto camera = Camera::build(scene.description, job.width, job.height);
  EXPECT_TRUE(camera.ok());
  TileTask task;
  task.kind = TaskKind::kPilot;
  task.tile = job.crop;
  task.pilot_blocks = 1;
  std::vector<ChosenMix> candidates;
  for (const std::string& name : names) candidates.push_back({0, *parse_mix(name)});
  const Rendering rendering{scene,     job,       *camera,
                            task.kind, task.tile, light_pixels(scene, *camera, task.tile)};
  const std::atomic<bool> cancel{false};
  return measure_candidates(rendering, task, candidates, cancel);
}

/// Fog in all of space, with `light` in it.
ScenePtr foggy(std::string_view light) {
  return test::load_text(std::string(R"(MakeNamedMedium "fog" "string type" "homogeneous"
  "rgb sigma_s" [ 0.1 0.1 0.1 ] "rgb sigma_a" [ 0 0 0 ]
MediumInterface "" "fog"
LookAt 0 3 4  0 0 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
)") + std::string(light));
}

// Without the effect, or without a light that lines can start from, such a candidate is the twin of another.
TEST(CandidatePilot, MediumLinesAreTriedWhereMediaAndALightServeThem) {
  const std::vector<std::string> names = {"sa:2", "sa:2/medium=line"};
  const auto tried = [&](const ScenePtr& scene) {
    EXPECT_TRUE(scene);
    const std::vector<MixCost> costs = pilot(*scene, names);
    EXPECT_EQ(costs.size(), 2u);
    EXPECT_GT(costs[0].pixels, 0);
    return costs[1].pixels > 0;
  };
  EXPECT_FALSE(tried(test::load_text(kSmallLamp)));
  EXPECT_TRUE(tried(foggy("LightSource \"spot\" \"point3 from\" [ 0 3 0 ] \"point3 to\" [ 0 0 0 ]")));
  EXPECT_FALSE(tried(foggy("LightSource \"distant\" \"point3 from\" [ 0 3 0 ] \"point3 to\" [ 0 0 0 ]")));
}

TEST(CandidatePilot, SaysWhereALobeIsNarrow) {
  const auto measured = [](const std::string& material) {
    std::string text = kSmallLamp;
    text.replace(text.find("\"matte\""), 7, material);
    const ScenePtr scene = test::load_text(text);
    EXPECT_TRUE(scene);
    return pilot(*scene, {"sa:4"})[0];
  };
  EXPECT_EQ(measured("\"matte\"").lobed_pixels, 0);
  EXPECT_EQ(measured("\"plastic\" \"float roughness\" 0.5").lobed_pixels, 0);
  const MixCost shiny = measured("\"plastic\" \"float roughness\" 0.001");
  EXPECT_GT(shiny.lobed_pixels, 0);
  EXPECT_LE(shiny.lobed_pixels, shiny.pixels);
  const auto in_fog = [](const std::string& g) {
    const ScenePtr scene =
        test::load_text(R"(MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [ 1 1 1 ]
  "rgb sigma_a" [ 0 0 0 ] "float g" )" +
                        g + "\nMediumInterface \"\" \"fog\"\n" + kSmallLamp);
    EXPECT_TRUE(scene);
    return pilot(*scene, {"sa:4"})[0].lobed_pixels;
  };
  EXPECT_EQ(in_fog("0.5"), 0);
  EXPECT_GT(in_fog("0.9"), 0);
}

TEST(CandidatePilot, AMixThatHasMissedTheLightIsNotWithoutNoise) {
  const ScenePtr scene = test::load_text(kSmallLamp);
  ASSERT_TRUE(scene);
  const std::vector<std::string> names = {"bsdf:4", "sa:4", "bsdf:2+sa:2"};
  const std::vector<MixCost> costs = pilot(*scene, names);
  ASSERT_EQ(costs.size(), 3u);
  EXPECT_GT(costs[0].relative_variance, 100 * costs[1].relative_variance);
  EXPECT_GT(costs[0].relative_variance, 100 * costs[2].relative_variance);
  // What has seen the light is judged by its own scatter alone: a point of this lamp varies little.
  EXPECT_LT(costs[1].relative_variance / double(costs[1].pixels), 0.01);
}

}  // namespace
}  // namespace penumbra

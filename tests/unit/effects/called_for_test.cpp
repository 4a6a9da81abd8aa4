// Only the effects that a scene calls for: what is built, and how often it is called.
#include <gtest/gtest.h>

#include <atomic>

#include "tests/support/render.h"
#include "worker/render/camera_stage.h"
#include "worker/render/scene.h"

namespace penumbra {
namespace {

const std::string kGallery = PENUMBRA_SOURCE_DIR "/scenes/gallery/";

TEST(CalledFor, PlainScenesHaveNoStage) {
  for (const char* name : {"monolith.pbrt", "monolith-glossy.pbrt", "pergola.pbrt", "hard/far.pbrt"}) {
    const ScenePtr scene = test::load(kGallery + name);
    ASSERT_TRUE(scene) << name;
    EXPECT_EQ(scene->effects.camera, nullptr) << name;
    EXPECT_EQ(scene->effects.media, nullptr) << name;
    EXPECT_FALSE(scene->effects.motion) << name;
  }
  const ScenePtr scene = test::load(kGallery + "lens.pbrt");
  ASSERT_TRUE(scene);
  EXPECT_NE(scene->effects.camera, nullptr);
  const ScenePtr fog = test::load(kGallery + "fog.pbrt");
  ASSERT_TRUE(fog);
  EXPECT_NE(fog->effects.media, nullptr);
  EXPECT_EQ(fog->effects.camera, nullptr);
  const ScenePtr motion = test::load(kGallery + "motion.pbrt");
  ASSERT_TRUE(motion);
  EXPECT_TRUE(motion->effects.motion);
  EXPECT_NE(motion->effects.camera, nullptr);
  EXPECT_FALSE(motion->effects.lens);
}

/// A stage that passes the pinhole's ray on, and counts.
class Counting : public CameraStage {
 public:
  explicit Counting(std::atomic<int>& calls) : calls_(calls) {}
  void rays(const CameraRay& pinhole, const CameraDraw&, std::vector<WeightedRay>& out) const override {
    ++calls_;
    out.assign(1, {pinhole, 1});
  }
  double blur(double) const override { return 0; }

 private:
  std::atomic<int>& calls_;
};

TEST(CalledFor, AStageIsCalledOncePerCameraRayAndChangesNothingByItself) {
  // No pixel sees the light, so none has emission rays of its own.
  const ScenePtr scene = test::load_text(
      "Camera \"perspective\"\nWorldBegin\nShape \"trianglemesh\" \"integer indices\" [ 0 1 2 ] "
      "\"point P\" [ -5 -5 3  5 -5 3  0 5 3 ]\n"
      "AttributeBegin AreaLightSource \"diffuse\" Shape \"quad\" \"point o\" [ -1 -1 -1 ] \"vector u\" [ 2 0 "
      "0 ] "
      "\"vector v\" [ 0 2 0 ] AttributeEnd\n");
  ASSERT_TRUE(scene);
  const JobSpec job = test::job(12, 9, {"bsdf:1+sa:1", "line-sa@u:1/balance/lens=line"}, 5);
  const test::Rendered plain = test::render(*scene, job);
  std::atomic<int> calls = 0;
  scene->effects.camera = std::make_shared<const Counting>(calls);
  const test::Rendered staged = test::render(*scene, job);
  EXPECT_EQ(calls, 12 * 9 * 5 * 2);
  for (size_t m = 0; m < 2; ++m) EXPECT_EQ(plain.images[m].rgb, staged.images[m].rgb);
}

/// No ray is ever inside a tube, so what medium pbrt's text puts there does not matter: a strand lit from
/// behind, in fog.
TEST(CalledFor, TheInsideOfATubeIsNoMedium) {
  const auto picture = [](const std::string& inside) {
    const ScenePtr scene = test::load_text("LookAt 0 0 -4  0 0 0  0 1 0\nMediumInterface \"\" \"fog\"\n" +
                                           std::string(R"(Camera "perspective" "float fov" 30
WorldBegin
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [ 0.5 0.5 0.5 ] "rgb sigma_s" [ 0.1 0.1 0.1 ]
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 50 50 50 ]
Shape "quad" "point o" [ -1 -1 3 ] "vector u" [ 0 2 0 ] "vector v" [ 2 0 0 ] AttributeEnd
Material "hair" "float eumelanin" 0.1
MediumInterface ")") + inside + R"(" "fog"
Shape "curve" "string type" "cylinder" "float width" 0.5 "point P" [ 0 -2 0  0 -1 0  0 1 0  0 2 0 ]
)");
    EXPECT_TRUE(scene);
    return test::render(*scene, test::job(16, 16, {"sa:2"}, 4)).images[0].rgb;
  };
  EXPECT_EQ(picture(""), picture("fog"));
}

}  // namespace
}  // namespace penumbra

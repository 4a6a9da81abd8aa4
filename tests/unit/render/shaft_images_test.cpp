// Images with shafts and without are the same bits.
#include <gtest/gtest.h>

#include "tests/support/render.h"
#include "worker/render/scene.h"

namespace penumbra {
namespace {

/// Two lights, one of them a triangle low over the floor; spheres, a translucent leaf and a plate that hides
/// the light altogether from what lies below it.
const char* const kScene = R"(LookAt 0 3 6  0 0.5 0  0 1 0
Camera "perspective" "float fov" 50
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 5 5 5 ]
Shape "quad" "point o" [ -0.7 2.2 -0.5 ] "vector u" [ 1.4 0 0 ] "vector v" [ 0 0 0.9 ]
AreaLightSource "diffuse" "rgb L" [ 9 5 2 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 ] "point P" [ 2 0 -1  2 1 -1  2 0.2 1 ]
AttributeEnd
Material "plastic"
Shape "sphere" "float radius" 0.7
Material "translucent"
Shape "trianglemesh" "integer indices" [ 0 1 2 ] "point P" [ -2 0 1  -1 0.9 1  -1 0 0.5 ]
Material "matte"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 -0.7 -4  -4 -0.7 4  4 -0.7 4  4 -0.7 -4 ]
Shape "trianglemesh" "integer indices" [ 0 1 2 ] "point P" [ -9 1.2 -3  9 1.2 -3  0 1.2 -0.8 ]
)";

TEST(ShaftImages, AreTheSameBits) {
  const std::vector<std::string> mixes = {
      "line-sa@v:4",           "bsdf:1+line-sa@v:3",        "sa:16",
      "area:2+sa:2",           "sa:2+line-area@30:2",       "line-sa@u:2+line-sa@v:2/average",
      "sa:4+line-sa@u:1/free", "bsdf:1+line-area@0:2/power"};
  const JobSpec spec = test::job(96, 72, mixes, 3);
  const ScenePtr with = test::load_text(kScene), without = test::load_text(kScene);
  ASSERT_TRUE(with && without);
  without->lights.shafts = false;
  const test::Rendered a = test::render(*with, spec), b = test::render(*without, spec);
  for (size_t m = 0; m < mixes.size(); ++m) {
    SCOPED_TRACE(mixes[m]);
    EXPECT_EQ(a.images[m].rgb, b.images[m].rgb);
    EXPECT_EQ(a.images[m].variance, b.images[m].variance);
  }
  EXPECT_LT(a.costs[2].rays, b.costs[2].rays) << "no shaft spared a shadow ray";
}

}  // namespace
}  // namespace penumbra

// Depth of field by points of the lens against chords of it: the same picture by two roads.
#include <gtest/gtest.h>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

test::AgreementSpec small_picture() {
  test::AgreementSpec how;
  how.width = 96;
  how.height = 64;
  return how;
}

const std::vector<std::string> kMixes = {"bsdf:1+sa:1", "bsdf:1+sa:1/balance/lens=line", "line-sa@u:2",
                                         "line-sa@u:2/balance/lens=line"};

TEST(Lens, PointsAndLinesAgreeOnTheGallerysScene) {
  test::expect_agreement(test::load(PENUMBRA_SOURCE_DIR "/scenes/gallery/lens.pbrt"), kMixes,
                         small_picture());
}

TEST(Lens, PointsAndLinesAgreeWithEverySampler) {
  for (const SamplerKind sampler : {SamplerKind::kStratified, SamplerKind::kSobol}) {
    test::AgreementSpec how = small_picture();
    how.sampler = sampler;
    how.group = 8;
    test::expect_agreement(test::load(PENUMBRA_SOURCE_DIR "/scenes/gallery/lens.pbrt"), kMixes, how);
  }
}

/// A map behind everything, cut-out leaves that lines do not see, and a lens as wide as the scene.
TEST(Lens, PointsAndLinesAgreeBeforeASkyAndBehindAlpha) {
  test::AgreementSpec how;
  test::expect_agreement(test::load_text(
                             R"(LookAt 0 1 5  0 0.6 0  0 1 0
Camera "perspective" "float fov" 40 "float lensradius" 0.8 "float focaldistance" 4.5
WorldBegin
LightSource "infinite" "rgb L" [ 0.2 0.3 0.5 ]
Texture "holes" "float" "checkerboard" "float uscale" 4 "float vscale" 4 "float tex1" 0 "float tex2" 1
AttributeBegin AreaLightSource "diffuse" "rgb L" [ 9 8 7 ]
Shape "quad" "point o" [ -0.5 2 -2 ] "vector u" [ 1 0 0 ] "vector v" [ 0 0.4 0.2 ] AttributeEnd
Material "matte"
Shape "trianglemesh" "integer indices" [ 0 1 2 0 2 3 ] "point P" [ -4 0 -4  -4 0 4  4 0 4  4 0 -4 ]
AttributeBegin Translate 0 0.5 0.3 Shape "sphere" "float radius" 0.5 AttributeEnd
Shape "trianglemesh" "texture alpha" "holes" "integer indices" [ 0 1 2 0 2 3 ]
  "point P" [ -1 0 2  1 0 2.2  1 2 2.2  -1 2 2 ] "float uv" [ 0 0 1 0 1 1 0 1 ]
)"),
                         {"bsdf:1+sa:1", "bsdf:1+sa:1/balance/lens=line"}, how);
}

}  // namespace
}  // namespace penumbra

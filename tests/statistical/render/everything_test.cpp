// All effects in one scene: where they meet, points and lines must still agree, the picture and every bin of
// path length.
#include <gtest/gtest.h>

#include "tests/statistical/render/agreement.h"

namespace penumbra {
namespace {

const std::vector<std::string> kMixes = {"bsdf:1+sa:1",
                                         "sa:2/balance/lens=line/medium=line",
                                         "bsdf:1+line-sa@u:1",
                                         "line-sa@v:2/balance/motion=line/medium=line",
                                         "line-area@30:2/balance/lens=line",
                                         "bsdf:1+visible-area:1/balance/motion=line"};

ScenePtr everything() {
  return test::load(PENUMBRA_SOURCE_DIR "/scenes/gallery/everything.pbrt");
}

TEST(Everything, PointsAndLinesAgreeWhereEffectsMeet) {
  test::AgreementSpec how;
  how.width = 72;
  how.height = 48;
  how.passes = 48;
  test::expect_agreement(everything(), kMixes, how);
}

TEST(Everything, AlsoInEveryBinOfPathLength) {
  test::AgreementSpec how;
  how.width = 48;
  how.height = 32;
  how.passes = 48;
  how.transient = Transient{6, 11, 10};
  test::expect_agreement(everything(), kMixes, how);
}

}  // namespace
}  // namespace penumbra

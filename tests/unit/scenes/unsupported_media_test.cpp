#include <gmock/gmock.h>

#include "scenes/needs.h"
#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> warnings(const std::string& medium, const std::string& used = "m") {
  return unsupported(parsed("MakeNamedMedium \"m\" \"string type\" " + medium +
                            "\nWorldBegin MediumInterface \"" + used + "\" \"\" Shape \"sphere\""));
}

TEST(UnsupportedMedia, WhatIsRenderedIsNotNamed) {
  EXPECT_THAT(warnings("\"homogeneous\" \"rgb sigma_a\" [ 1 1 1 ] \"float g\" 0.5"), IsEmpty());
  EXPECT_THAT(warnings("\"uniformgrid\" \"float density\" 1"), IsEmpty());
  EXPECT_THAT(unsupported(parsed("MakeNamedMedium \"m\" \"string type\" \"nanovdb\" WorldBegin")), IsEmpty());
}

TEST(UnsupportedMedia, WhatIsLeftOutIs) {
  EXPECT_THAT(warnings("\"nanovdb\""),
              ElementsAre(HasSubstr(":1:1: medium 'm' of type 'nanovdb' is not supported")));
  EXPECT_THAT(warnings("\"homogeneous\" \"string preset\" \"Skimmilk\" \"rgb Le\" [ 1 1 1 ]"),
              ElementsAre(HasSubstr("preset 'Skimmilk'"), HasSubstr("emission (Le)")));
  EXPECT_THAT(warnings("\"homogeneous\"", "haze"),
              ElementsAre(HasSubstr(":2:38: there is no medium 'haze'")));
}

}  // namespace
}  // namespace penumbra

#include "scenes/substitutes.h"

#include <gmock/gmock.h>

#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> told(const std::string& text) {
  const SceneFolder folder;
  folder.write("there.png", "bytes");
  const auto description = folder.parse("WorldBegin\n" + text);
  EXPECT_TRUE(description.ok()) << message_of(description.status());
  return substitutes(*description, folder.files());
}

TEST(Substitutes, ImagesThatAreNotThere) {
  const std::string texture =
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"gone.png\"\n"
      "Texture \"twice\" \"spectrum\" \"scale\" \"texture tex1\" \"t\" \"rgb tex2\" [ 2 2 2 ]\n";
  EXPECT_THAT(told(texture), IsEmpty()) << "nothing wears it";
  EXPECT_THAT(
      told(texture + "Material \"matte\" \"texture Kd\" \"twice\" Shape \"sphere\""),
      ElementsAre(HasSubstr("a.pbrt:2:1: image 'gone.png' of texture 't' cannot be read (no such file")));
  EXPECT_THAT(told("Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"gone.png\"\n"
                   "Shape \"sphere\" \"texture alpha\" \"t\""),
              ElementsAre(HasSubstr("gone.png")));
  EXPECT_THAT(told("Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"there.png\"\n"
                   "Shape \"sphere\" \"texture alpha\" \"t\""),
              IsEmpty());
  EXPECT_THAT(told("LightSource \"infinite\" \"string mapname\" \"sky.exr\""),
              ElementsAre(HasSubstr("a.pbrt:2:1: environment map 'sky.exr' is missing; constant 1 instead")));
  EXPECT_THAT(told("Material \"diffuse\" \"string normalmap\" \"n.png\" Shape \"sphere\""),
              ElementsAre(HasSubstr("a.pbrt:2:20: normal map 'n.png' cannot be read")));
}

TEST(Substitutes, MaterialsThatAreNotRendered) {
  EXPECT_THAT(told("Material \"disney\"\nMaterial \"matte\" Shape \"sphere\""), IsEmpty());
  EXPECT_THAT(told("Material \"disney\" Shape \"sphere\" Material \"subsurface\" Shape \"sphere\""),
              ElementsAre(HasSubstr("a.pbrt:2:1: material 'disney' is not supported: substrate instead"),
                          HasSubstr("material 'subsurface' is not supported: matte instead")));
}

}  // namespace
}  // namespace penumbra

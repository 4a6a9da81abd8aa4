#include "scenes/needs.h"

#include <gmock/gmock.h>

#include "scenes/check.h"
#include "scenes/leave_out.h"
#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> effects(std::string_view text) {
  std::vector<std::string> out;
  for (const Need& need : needs_of(parsed(text))) {
    EXPECT_THAT(need.why, HasSubstr("a.pbrt:1:")) << need.effect;
    out.push_back(need.effect);
  }
  return out;
}

TEST(Needs, APlainSceneNeedsNothing) {
  EXPECT_THAT(effects("Camera \"perspective\" \"float lensradius\" 0 WorldBegin Material \"matte\" "
                      "AreaLightSource \"diffuse\" Shape \"sphere\""),
              IsEmpty());
}

TEST(Needs, EachEffectIsSeen) {
  EXPECT_THAT(effects("Camera \"perspective\" \"float lensradius\" 0.1 WorldBegin"), ElementsAre("lens"));
  // A pinhole stands in for it, whatever its lenses.
  EXPECT_THAT(effects("Camera \"realistic\" \"string lensfile\" \"a.dat\" WorldBegin"), IsEmpty());
  EXPECT_THAT(effects("WorldBegin LightSource \"infinite\""), ElementsAre("environment"));
  EXPECT_THAT(effects("WorldBegin Shape \"curve\""), ElementsAre("curves"));
  EXPECT_THAT(effects("WorldBegin MediumInterface \"a\" \"\" Shape \"sphere\""), ElementsAre("media"));
  EXPECT_THAT(effects("MediumInterface \"\" \"a\" Camera \"perspective\" WorldBegin"), ElementsAre("media"));
  EXPECT_THAT(effects("WorldBegin Shape \"sphere\" \"float alpha\" 0"), ElementsAre("alpha"));
  EXPECT_THAT(effects("WorldBegin Material \"mirror\" Shape \"sphere\""), ElementsAre("specular"));
  EXPECT_THAT(
      effects("WorldBegin Texture \"t\" \"float\" \"constant\" Material \"matte\" \"texture bumpmap\" \"t\" "
              "Shape \"sphere\""),
      ElementsAre("textures", "bump"));
}

TEST(Needs, MotionNeedsAnOpenShutterAndSomethingThatMoves) {
  const std::string_view moving = "WorldBegin ActiveTransform EndTime Translate 1 0 0 Shape \"sphere\"";
  EXPECT_THAT(effects(moving), ElementsAre("motion"));
  EXPECT_THAT(effects(fmt::format("Camera \"perspective\" \"float shutterclose\" 0 {}", moving)), IsEmpty());
}

TEST(Needs, MaterialsCountWhereTheyAreWorn) {
  EXPECT_THAT(effects("WorldBegin MakeNamedMaterial \"m\" \"string type\" \"mirror\" Shape \"sphere\""),
              IsEmpty());
  EXPECT_THAT(effects("WorldBegin MakeNamedMaterial \"m\" \"string type\" \"mirror\" Material \"mix\" "
                      "\"string namedmaterial1\" \"m\" \"string namedmaterial2\" \"none\" Shape \"sphere\""),
              ElementsAre("specular"));
}

TEST(LeaveOut, TakesOneEffectAwayAndNoOther) {
  const std::string_view text =
      "ActiveTransform EndTime Translate 0 0 1 ActiveTransform All MediumInterface \"\" \"a\" "
      "Camera \"perspective\" \"float lensradius\" 0.1 WorldBegin LightSource \"infinite\" "
      "Texture \"t\" \"spectrum\" \"constant\" Shape \"curve\" Material \"matte\" \"texture Kd\" \"t\" "
      "\"string "
      "normalmap\" \"n\" Shape \"sphere\" \"float alpha\" 0 Material \"mirror\" ObjectBegin \"o\" "
      "MediumInterface \"b\" \"\" Shape \"curve\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"";
  const auto names = [](const SceneDescription& scene) {
    std::vector<std::string> out;
    for (const Need& need : needs_of(scene)) out.push_back(need.effect);
    return out;
  };
  const std::vector<std::string> all = names(parsed(text));
  EXPECT_EQ(all.size(), 9u) << "the text calls for every effect that there is";
  for (const std::string& effect : all) {
    SceneDescription scene = parsed(text);
    ASSERT_TRUE(leave_out(effect, scene).ok()) << effect;
    std::vector<std::string> rest = all;
    std::erase(rest, effect);
    EXPECT_EQ(names(scene), rest) << "without " << effect;
  }
  SceneDescription scene = parsed(text);
  EXPECT_TRUE(absl::IsInvalidArgument(leave_out("lenses", scene)));
}

TEST(Needs, RoughGlassIsNotSpecular) {
  EXPECT_THAT(effects("WorldBegin Material \"glass\" Shape \"sphere\""), ElementsAre("specular"));
  EXPECT_THAT(
      effects(
          "WorldBegin Material \"glass\" \"float uroughness\" .1 \"float vroughness\" .1 Shape \"sphere\""),
      IsEmpty());
  EXPECT_THAT(effects("WorldBegin Material \"dielectric\" \"float roughness\" .1 Shape \"sphere\""),
              IsEmpty());
  EXPECT_THAT(effects("WorldBegin Material \"metal\" Shape \"sphere\""), IsEmpty());
  EXPECT_THAT(effects("WorldBegin Material \"conductor\" Shape \"sphere\""), ElementsAre("specular"));
  EXPECT_THAT(effects("WorldBegin Material \"uber\" Shape \"sphere\""), IsEmpty());
  EXPECT_THAT(effects("WorldBegin Material \"uber\" \"rgb opacity\" [1 .5 1] Shape \"sphere\""),
              ElementsAre("specular"));
}

TEST(Unsupported, NamesWhatIsLeftOutOnce) {
  const SceneDescription scene = parsed(
      "Camera \"environment\" Integrator \"bdpt\" WorldBegin Shape \"cone\" Shape \"cone\" Shape \"sphere\" "
      "LightSource \"goniometric\" LightSource \"point\"");
  EXPECT_THAT(
      unsupported(scene),
      ElementsAre(HasSubstr("camera 'environment'"), HasSubstr("integrator 'bdpt' asks for indirect light"),
                  HasSubstr("shape 'cone' is not supported: 2 left out"), HasSubstr("light 'goniometric'")));
}

TEST(Unsupported, APictureWithoutItsOnlyLightIsSaidToBeBlack) {
  const std::string_view dark = "WorldBegin LightSource \"projection\" Shape \"sphere\"";
  EXPECT_THAT(unsupported(parsed(dark)), ElementsAre(HasSubstr("light 'projection'"),
                                                     HasSubstr("no light is left: the picture is black")));
  for (const std::string_view light :
       {"LightSource \"point\"", "AreaLightSource \"diffuse\" Shape \"sphere\""})
    EXPECT_THAT(unsupported(parsed(fmt::format("{} {}", dark, light))),
                ElementsAre(HasSubstr("light 'projection'")))
        << light;
  EXPECT_FALSE(is_rendered(parsed(dark).lights[0]));
}

TEST(Unsupported, DirectLightIsSupported) {
  EXPECT_THAT(unsupported(parsed("Integrator \"path\" \"integer maxdepth\" 1 WorldBegin")), IsEmpty());
  EXPECT_THAT(unsupported(parsed("Integrator \"directlighting\" WorldBegin")), IsEmpty());
  EXPECT_THAT(unsupported(parsed("Integrator \"pointline\" WorldBegin")), IsEmpty());
  EXPECT_THAT(unsupported(parsed("Integrator \"path\" WorldBegin")), ElementsAre(HasSubstr("indirect")));
}

std::string checked(std::string_view shape) {
  SceneFolder folder;
  folder.write("bad.ply",
               "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nelement face 1\n"
               "property list uchar int vertex_indices\nend_header\n1");
  const auto scene = folder.parse(fmt::format("WorldBegin ObjectBegin \"o\"\nShape {} ObjectEnd", shape));
  EXPECT_TRUE(scene.ok()) << message_of(scene.status());
  return message_of(check_files(*scene, folder.files()));
}

TEST(CheckFiles, ATextWithoutAWorldIsNoPicture) {
  SceneFolder folder;
  for (const char* text :
       {"", "Camera \"perspective\"\n", "MakeNamedMaterial \"m\" \"string type\" \"matte\"\n"}) {
    const auto scene = folder.parse(text);
    ASSERT_TRUE(scene.ok());
    EXPECT_THAT(message_of(check_files(*scene, folder.files())), HasSubstr("no WorldBegin"));
  }
}

TEST(CheckFiles, HairThatCannotBeIsRefusedAtItsPlace) {
  SceneFolder folder;
  const auto fault = [&](std::string_view params) {
    const auto scene = folder.parse(fmt::format("WorldBegin\nMaterial \"hair\" {}", params));
    EXPECT_TRUE(scene.ok());
    return message_of(check_files(*scene, folder.files()));
  };
  EXPECT_EQ(fault("\"float beta_m\" 1.5"), "a.pbrt:2:17: beta_m 1.5 is not in [0, 1]");
  for (const char* params : {"\"float beta_n\" -0.1", "\"float eta\" 0.5", "\"float alpha\" 91",
                             "\"float eumelanin\" -1", "\"float pheomelanin\" -1"})
    EXPECT_THAT(fault(params), testing::StartsWith("a.pbrt:2:17: ")) << params;
  EXPECT_EQ(fault("\"float beta_m\" 1 \"float beta_n\" 0 \"float eta\" 1 \"rgb color\" [ 1 1 1 ]"), "");
}

TEST(CheckFiles, SeesWhatAClientCanKnow) {
  using testing::StartsWith;
  EXPECT_THAT(checked("\"plymesh\" \"string filename\" \"missing.ply\""),
              StartsWith("a.pbrt:2:1: plymesh 'missing.ply'"));
  EXPECT_THAT(checked("\"plymesh\" \"string filename\" \"/etc/passwd\""), HasSubstr("not a PLY file"));
  EXPECT_THAT(checked("\"plymesh\" \"string filename\" \"bad.ply\""), HasSubstr("promises"));
  EXPECT_THAT(checked("\"trianglemesh\" \"integer indices\" [0 1 9] \"point P\" [0 0 0 1 0 0 0 1 0]"),
              HasSubstr("index 9"));
  EXPECT_THAT(checked("\"sphere\" \"float radius\" -1"), HasSubstr("radius -1"));
  EXPECT_EQ(checked("\"sphere\""), "");
  EXPECT_EQ(checked("\"nurbs\""), "");
}

}  // namespace
}  // namespace penumbra

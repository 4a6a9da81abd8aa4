#include "scenes/parser.h"

#include <gmock/gmock.h>

#include "tests/unit/scenes/scene_folder.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// ---- parameters ----

/// The parameters of a sphere in an otherwise empty world.
Params params_of(std::string_view text) {
  const SceneDescription scene = parsed(fmt::format("WorldBegin Shape \"sphere\" {}", text));
  return scene.shapes.empty() ? Params() : scene.shapes[0].params;
}

TEST(Parameters, SingleValuesNeedNoBrackets) {
  const Params params =
      params_of("\"float radius\" 2 \"bool a\" \"true\" \"bool b\" false \"string s\" \"x\"");
  EXPECT_EQ(params.number("radius", 0), 2);
  EXPECT_TRUE(params.boolean("a", false));
  EXPECT_FALSE(params.boolean("b", true));
  EXPECT_EQ(params.string("s", ""), "x");
}

TEST(Parameters, TypesAreNormalised) {
  const Params params = params_of(
      "\"color a\" [1 2 3] \"point b\" [1 2 3] \"vector c\" [1 2 3] \"normal3 d\" [1 2 3] \"xyz e\" [1 2 3]"
      "\"blackbody f\" [6500 100] \"spectrum g\" \"x.spd\" \"spectrum h\" [400 1 700 1] \"point2 i\" [1 2]");
  std::vector<std::string> types;
  for (const Param& param : params.all) types.push_back(param.type);
  EXPECT_THAT(types, ElementsAre("rgb", "point3", "vector3", "normal", "xyz", "blackbody", "spectrum",
                                 "spectrum", "point2"));
  EXPECT_THAT(params.find("f")->numbers, ElementsAre(6500, 100));
  EXPECT_THAT(params.find("g")->strings, ElementsAre("x.spd"));
}

TEST(Parameters, DeclarationsMayHaveTabsAndExtraBlanks) {
  EXPECT_EQ(params_of("\"float\tradius\" 3").number("radius", 0), 3);
  EXPECT_EQ(params_of("\" float  radius \" 3").number("radius", 0), 3);
}

TEST(Parameters, OfANameGivenTwiceTheLastWins) {
  EXPECT_EQ(params_of("\"integer n\" [1800] \"integer n\" [700]").integer("n", 0), 700);
}

TEST(Parameters, AnotherTypeMeansTheFallback) {
  const Params params = params_of("\"string radius\" \"3\" \"float n\" 2");
  EXPECT_EQ(params.number("radius", 7), 7);
  EXPECT_EQ(params.integer("n", 5), 5);
  EXPECT_EQ(params.string("missing", "x"), "x");
}

TEST(Parameters, IntegersMayBeWrittenAsFloats) {
  EXPECT_EQ(params_of("\"integer maxdepth\" [8.0]").integer("maxdepth", 0), 8);
  const SceneDescription scene = parsed("WorldBegin Shape \"sphere\" \"integer n\" [8.5]");
  EXPECT_EQ(scene.shapes[0].params.integer("n", 0), 8);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("cut to 8")));
}

TEST(Parameters, CommentsMayStandInsideArrays) {
  EXPECT_THAT(params_of("\"point P\" [0 0 0 # first\n 1 1 1 ]").find("P")->numbers.size(), 6u);
}

TEST(Parameters, LeftOverNumbersAreDroppedWithAWarning) {
  const SceneDescription scene = parsed("WorldBegin Shape \"sphere\" \"point P\" [1 2 3 4]");
  EXPECT_EQ(scene.shapes[0].params.find("P")->numbers.size(), 3u);
  EXPECT_THAT(scene.warnings, ElementsAre(StartsWith("a.pbrt:1:27: ")));
}

TEST(Parameters, ErrorsNameTheirPlace) {
  const std::string before = "WorldBegin\nShape \"sphere\" ";
  EXPECT_THAT(error_of(before + "\"float radius\" [ nan ]"),
              AllOf(StartsWith("a.pbrt:2:33: "), HasSubstr("nan")));
  EXPECT_THAT(error_of(before + "\"float radius\" inf"), StartsWith("a.pbrt:2:31: "));
  EXPECT_THAT(error_of(before + "\"float radius\" 1e39"), HasSubstr("not finite in single precision"));
  EXPECT_THAT(error_of(before + "\"integer n\" 3000000000"), HasSubstr("32 bits"));
  EXPECT_THAT(error_of(before + "\"float radius\" [1"), HasSubstr("never closed"));
  EXPECT_THAT(error_of(before + "\"float radius\""), HasSubstr("has no value"));
  EXPECT_THAT(error_of(before + "\"float radius\" \"1\""), HasSubstr("takes numbers"));
  EXPECT_THAT(error_of(before + "\"float radius\" [1 [2]]"), HasSubstr("has no value"));
  EXPECT_THAT(error_of(before + "\"flaot radius\" 1"), HasSubstr("unknown parameter type 'flaot'"));
  EXPECT_THAT(error_of(before + "\"radius\" 1"), HasSubstr("type name"));
  EXPECT_THAT(error_of(before + "\"bool b\" maybe"), HasSubstr("neither true nor false"));
  EXPECT_THAT(error_of(before + "\"rgb L\" [1 2]"), HasSubstr("takes 3 numbers"));
  EXPECT_THAT(error_of(before + "\"spectrum L\" [1 \"x\"]"), HasSubstr("mixes"));
}

TEST(Parameters, MillionsOfNumbersAreFast) {
  std::string text = "WorldBegin Shape \"trianglemesh\" \"point P\" [";
  for (int i = 0; i < 1'000'000; ++i) text += "0.123456 -7.5e-3 1 ";
  const SceneDescription scene = parsed(text + "]");
  EXPECT_EQ(scene.shapes.at(0).params.find("P")->numbers.size(), 3'000'000u);
}

// ---- directives ----

TEST(Directives, UnknownWordsAreErrorsWithTheirPlace) {
  EXPECT_EQ(error_of("Camera \"perspective\"\n  BackBounce"), "a.pbrt:2:3: unknown directive 'BackBounce'");
  EXPECT_THAT(error_of("SurfaceIntegrator \"path\""), HasSubstr("unknown directive"));
  EXPECT_THAT(error_of("]"), HasSubstr("expected a directive"));
  EXPECT_THAT(error_of("\"Shape\""), HasSubstr("expected a directive"));
}

TEST(Directives, NamesOfNoPbrtAreErrorsForShapesAndLights) {
  EXPECT_THAT(error_of("WorldBegin Shape \"qaud\""), StartsWith("a.pbrt:1:12: unknown shape 'qaud'"));
  EXPECT_THAT(error_of("WorldBegin LightSource \"pointt\""), HasSubstr("unknown light source 'pointt'"));
  EXPECT_THAT(error_of("WorldBegin AreaLightSource \"x\""), HasSubstr("unknown area light source"));
}

TEST(Directives, NamesOfNoPbrtAreWarningsElsewhere) {
  const SceneDescription scene = parsed(
      "Sampler \"bushpp\" Integrator \"pssps\" WorldBegin Material \"pyramid\" Texture \"t\" \"float\" "
      "\"x\"");
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("bushpp"), HasSubstr("pssps"), HasSubstr("pyramid"),
                                          HasSubstr("texture 'x'")));
}

TEST(Directives, ShapesOfPbrtThatAreNotRenderedParse) {
  const SceneDescription scene = parsed("WorldBegin Shape \"cone\" Shape \"nurbs\" Shape \"curve\"");
  EXPECT_EQ(scene.shapes.size(), 3u);
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST(Directives, OfRepeatedOptionsTheLastWins) {
  const SceneDescription scene = parsed("Film \"image\" \"integer xresolution\" 5 Film \"image\" WorldBegin");
  EXPECT_EQ(scene.film.params.integer("xresolution", 640), 640);
}

TEST(Directives, OutOfPlaceMeansLeftOutAndSaid) {
  const SceneDescription scene = parsed("Shape \"sphere\" Shape \"disk\" WorldBegin Film \"image\"");
  EXPECT_THAT(scene.shapes, IsEmpty());
  EXPECT_TRUE(scene.film.type.empty());
  EXPECT_THAT(scene.warnings,
              ElementsAre(HasSubstr("Shape before WorldBegin"), HasSubstr("Film after WorldBegin")));
}

TEST(Directives, WhatIsOutOfPlaceAgainAndAgainIsSaidOnce) {
  const SceneDescription scene =
      parsed("TransformTimes 0 2\nWorldBegin\nTransformTimes 0 3\nTransformTimes 0 4");
  EXPECT_EQ(scene.transform_end_time, 2);
  EXPECT_THAT(
      scene.warnings,
      ElementsAre("a.pbrt:3:1: TransformTimes after WorldBegin is left out, as in pbrt (said once of all "
                  "TransformTimes)"));
}

TEST(Directives, TextAfterWorldEndIsReadButNotRendered) {
  const SceneDescription scene =
      parsed("WorldBegin Shape \"sphere\" WorldEnd WorldBegin Shape \"disk\" WorldEnd");
  EXPECT_EQ(scene.shapes.size(), 1u);
  EXPECT_THAT(scene.warnings, testing::Not(IsEmpty()));
  EXPECT_THAT(error_of("WorldBegin WorldEnd Nonsense"), HasSubstr("Nonsense"));
}

TEST(Directives, Version4NeedsNoWorldEnd) {
  EXPECT_THAT(parsed("Option \"bool x\" false ColorSpace \"srgb\" WorldBegin Shape \"sphere\"").warnings,
              IsEmpty());
}

TEST(Directives, FilmSizesOutOfRangeAreErrors) {
  EXPECT_THAT(error_of("Film \"image\" \"integer xresolution\" 0"), HasSubstr("xresolution 0"));
  EXPECT_THAT(error_of("Film \"image\" \"integer yresolution\" -3"), HasSubstr("yresolution -3"));
  EXPECT_THAT(error_of("Film \"rgb\" \"integer xresolution\" 65537"), HasSubstr("from 1 to 65536"));
  EXPECT_THAT(error_of("Film \"rgb\" \"integer xresolution\" 65536 \"integer yresolution\" 65536"),
              HasSubstr("pixels"));
  EXPECT_TRUE(
      SceneFolder().parse("Film \"rgb\" \"integer xresolution\" 65536 \"integer yresolution\" 4096").ok());
}

TEST(Directives, AreaIsTheOldNameOfDiffuse) {
  EXPECT_EQ(parsed("WorldBegin AreaLightSource \"area\"").area_lights.at(0).type, "diffuse");
}

TEST(Directives, AttributeGivesDefaultsThatTheEntityOverrides) {
  const SceneDescription scene = parsed(
      "WorldBegin AttributeBegin Attribute \"shape\" \"float radius\" 3 Shape \"sphere\" "
      "Shape \"sphere\" \"float radius\" 4 AttributeEnd Shape \"sphere\"");
  EXPECT_EQ(scene.shapes.at(0).params.number("radius", 1), 3);
  EXPECT_EQ(scene.shapes.at(1).params.number("radius", 1), 4);
  EXPECT_EQ(scene.shapes.at(2).params.number("radius", 1), 1);
  EXPECT_THAT(error_of("Attribute \"camera\" \"float x\" 1"), HasSubstr("unknown target"));
}

// ---- includes ----

TEST(Include, IsTextAlsoInTheMiddleOfADirective) {
  SceneFolder folder;
  folder.write("geometry/medium.pbrt", "MakeNamedMedium \"smoke\" \"integer nx\" 4");
  folder.write("radius.pbrt", "\"float radius\"");
  const auto scene = folder.parse(
      "Include \"geometry/medium.pbrt\" \"string type\" \"heterogeneous\" WorldBegin Shape \"sphere\" "
      "Include \"radius.pbrt\" 5");
  ASSERT_TRUE(scene.ok()) << message_of(scene.status());
  EXPECT_EQ(scene->media.at(0).type, "heterogeneous");
  EXPECT_EQ(scene->media.at(0).params.integer("nx", 0), 4);
  EXPECT_EQ(scene->shapes.at(0).params.number("radius", 1), 5);
  EXPECT_THAT(scene->files, ElementsAre("a.pbrt", "geometry/medium.pbrt", "radius.pbrt"));
}

TEST(Include, NamesResolveAgainstTheMainFolder) {
  SceneFolder folder;
  folder.write("geometry/outer.pbrt", "Include \"geometry/inner.pbrt\"");
  folder.write("geometry/inner.pbrt", "WorldBegin\n Shape \"qaud\"");
  EXPECT_EQ(message_of(folder.parse("Include \"geometry/outer.pbrt\"").status()),
            "geometry/inner.pbrt:2:2: unknown shape 'qaud'");
}

TEST(Include, CyclesDepthAndMissingFilesAreErrors) {
  SceneFolder folder;
  EXPECT_THAT(message_of(folder.parse("\nInclude \"a.pbrt\"").status()),
              AllOf(StartsWith("a.pbrt:2:1: "), HasSubstr("includes itself")));
  EXPECT_THAT(message_of(folder.parse("Include \"none.pbrt\"").status()),
              HasSubstr("cannot include 'none.pbrt'"));
  for (int i = 0; i < 70; ++i) folder.write(fmt::format("f{}", i), fmt::format("Include \"f{}\"", i + 1));
  folder.write("f70", "");
  EXPECT_THAT(message_of(folder.parse("Include \"f0\"").status()), HasSubstr("more than 64 deep"));
  EXPECT_THAT(message_of(parse_scene("none.pbrt", folder.files()).status()), StartsWith("none.pbrt: "));
  EXPECT_THAT(message_of(folder.parse("Include Shape").status()), HasSubstr("quoted file name"));
  EXPECT_THAT(message_of(folder.parse("Include \".\"").status()), HasSubstr("not a regular file"));
}

TEST(Include, FilesThatDoubleAtEveryLevelAreRefused) {
  SceneFolder folder;
  for (int i = 0; i < 60; ++i) {
    folder.write(fmt::format("f{}", i), fmt::format("Include \"f{0}\"\nInclude \"f{0}\"", i + 1));
  }
  folder.write("f60", "");
  EXPECT_THAT(message_of(folder.parse("Include \"f0\"").status()), HasSubstr("again and again"));
}

TEST(Import, KeepsItsStateToItselfAndItsNamesForAll) {
  SceneFolder folder;
  folder.write("b.pbrt",
               "Translate 1 2 3 ReverseOrientation MakeNamedMaterial \"m\" \"string type\" \"matte\" "
               "AttributeBegin Shape \"sphere\"");
  const auto scene = folder.parse("WorldBegin Import \"b.pbrt\" NamedMaterial \"m\" Shape \"sphere\"");
  ASSERT_TRUE(scene.ok()) << message_of(scene.status());
  EXPECT_EQ(scene->shapes.at(0).placement.start[3][1], 2);
  EXPECT_TRUE(scene->shapes.at(0).reverse_orientation);
  EXPECT_EQ(scene->shapes.at(1).placement.start, Matrix());
  EXPECT_FALSE(scene->shapes.at(1).reverse_orientation);
  EXPECT_EQ(scene->shapes.at(1).material, 0);
}

TEST(Import, CannotCloseScopesThatItDidNotOpen) {
  SceneFolder folder;
  folder.write("b.pbrt", "TransformEnd AttributeEnd AttributeBegin TransformEnd AttributeEnd Scale 2 2 2");
  const auto scene = folder.parse(
      "WorldBegin Translate 1 0 0 AttributeBegin Translate 1 0 0 Import \"b.pbrt\" Shape \"sphere\" "
      "AttributeEnd Shape \"sphere\"");
  ASSERT_TRUE(scene.ok()) << message_of(scene.status());
  EXPECT_EQ(scene->shapes.at(0).placement.start[3][0], 2);
  EXPECT_EQ(scene->shapes.at(0).placement.start[0][0], 1);
  EXPECT_EQ(scene->shapes.at(1).placement.start[3][0], 1);
}

TEST(Garbage, NeverParses) {
  EXPECT_THAT(error_of("Camera \"perspective\"\nWorldBegin\n \"unterminated\n"), HasSubstr("closing quote"));
  EXPECT_THAT(error_of("\x89PNG\r\n\x1a\n"), StartsWith("a.pbrt:1:"));
}

}  // namespace
}  // namespace penumbra

// Materials by their parameters: what they make of a point, against the formulas written out here.
#include "worker/materials/material.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "proto/status.h"
#include "tests/unit/textures/temporary_scene.h"
#include "worker/textures/named_spectra.h"

namespace penumbra {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

SurfacePoint flat_point(const Vec3f& wo) {
  SurfacePoint point;
  point.p = Vec3f(0);
  point.uv = {0.3f, 0.7f};
  point.ng = point.ns = Vec3f(0, 0, 1);
  point.dpdu = Vec3f(1, 0, 0);
  point.dpdv = Vec3f(0, 1, 0);
  point.dndu = point.dndv = point.dpdx = point.dpdy = Vec3f(0);
  point.wo = wo;
  return point;
}

const Vec3f kWo = Vec3f(0.5f, 0.1f, 0.7f).normalized();
const Vec3f kWi = Vec3f(-0.4f, 0.2f, 0.8f).normalized();

class MaterialTest : public testing::Test {
 protected:
  absl::StatusOr<Materials> build(const std::string& text, bool strict = false) {
    description_ = scene_.parse(text + "\nShape \"sphere\"\n");
    last_ = static_cast<int>(description_.materials.size()) - 1;
    warnings_.clear();
    return Materials::build(description_, scene_.files(), strict, warnings_);
  }
  /// The last material of the text at a point.
  Bsdf bsdf(const std::string& text, const Vec3f& wo = kWo) {
    auto materials = build(text);
    EXPECT_TRUE(materials.ok()) << materials.status();
    if (!materials.ok()) return {flat_point(wo), Vec3f(0, 0, 1)};
    auto textures =
        Textures::build(description_, scene_.files(), materials->used_textures(), false, warnings_);
    EXPECT_TRUE(textures.ok()) << textures.status();
    has_specular_ = materials->has_specular(last_);
    return materials->shade(last_, flat_point(wo), *textures);
  }
  std::string fault(const std::string& text) { return message_of(build(text).status()); }

  TemporaryScene scene_;
  SceneDescription description_;
  std::vector<std::string> warnings_;
  int last_ = -1;
  bool has_specular_ = false;
};

/// pbrt-v3's D, as its book writes it.
double book_d(const Vec3d& wh, double alpha) {
  const double tan2 = (wh.x * wh.x + wh.y * wh.y) / (wh.z * wh.z), cos4 = std::pow(wh.z, 4);
  const double e = tan2 / (alpha * alpha);
  return 1 / (kPi * alpha * alpha * cos4 * (1 + e) * (1 + e));
}
double book_lambda(const Vec3d& w, double alpha) {
  return (-1 + std::sqrt(1 + alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z))) / 2;
}
double book_torrance_sparrow(double alpha, double fresnel) {
  const Vec3d wo(kWo), wi(kWi), wh = (wo + wi).normalized();
  return book_d(wh, alpha) / (1 + book_lambda(wo, alpha) + book_lambda(wi, alpha)) * fresnel /
         (4 * wo.z * wi.z);
}
double cos_half() {
  return Vec3d(kWi) ^ (Vec3d(kWo) + Vec3d(kWi)).normalized();
}

TEST_F(MaterialTest, DefaultIsMatteHalf) {
  const Bsdf b = Materials().shade(-1, flat_point(kWo), Textures());
  EXPECT_FLOAT_EQ(b.f(kWo, kWi).x, 0.5f / std::numbers::pi_v<float>);
}

TEST_F(MaterialTest, Matte) {
  EXPECT_FLOAT_EQ(bsdf(R"(Material "matte" "rgb Kd" [0.2 0.4 0.6])").f(kWo, kWi).y,
                  0.4f * std::numbers::inv_pi_v<float>);
  EXPECT_FLOAT_EQ(bsdf(R"(Material "diffuse" "rgb reflectance" [0.2 0.4 0.6])").f(kWo, kWi).z,
                  0.6f * std::numbers::inv_pi_v<float>);
  EXPECT_FALSE(has_specular_);
}

TEST_F(MaterialTest, MatteWithSigmaIsOrenNayar) {
  const Bsdf b = bsdf(R"(Material "matte" "rgb Kd" [1 1 1] "float sigma" 30)");
  const double s2 = std::pow(30 * kPi / 180, 2), a = 1 - s2 / (2 * (s2 + 0.33)), c = 0.45 * s2 / (s2 + 0.09);
  const double theta_o = std::acos(kWo.z), theta_i = std::acos(kWi.z);
  const double dphi = std::atan2(kWo.y, kWo.x) - std::atan2(kWi.y, kWi.x);
  const double expected = (a + c * std::max(0.0, std::cos(dphi)) * std::sin(std::max(theta_o, theta_i)) *
                                   std::tan(std::min(theta_o, theta_i))) /
                          kPi;
  EXPECT_NEAR(b.f(kWo, kWi).x, expected, 1e-6);
}

// pbrt-v3: indices 1.5 outside, 1 inside.
TEST_F(MaterialTest, PlasticIsLambertAndFacetsWithPbrtsIndices) {
  const Bsdf b =
      bsdf(R"(Material "plastic" "rgb Kd" [0.3 0.3 0.3] "rgb Ks" [0.9 0.9 0.9] "float roughness" 0.2
    "bool remaproughness" false)");
  const double fresnel = fresnel_dielectric(cos_half(), 1.5, 1);
  EXPECT_NEAR(b.f(kWo, kWi).x, 0.3 / kPi + 0.9 * book_torrance_sparrow(0.2, fresnel), 1e-6);
  // Beyond the critical angle the facets reflect everything.
  const Vec3f low_o = Vec3f(0.9f, 0, 0.3f).normalized(), low_i = Vec3f(-0.9f, 0, 0.3f).normalized();
  EXPECT_GT(b.f(low_o, low_i).x, 0.9 * book_d({0, 0, 1}, 0.2) / 4);
}

TEST_F(MaterialTest, RoughnessIsRemappedUnlessToldNot) {
  const double alpha = alpha_of_roughness_v3(0.2);
  const Bsdf b = bsdf(R"(Material "plastic" "rgb Kd" [0 0 0] "rgb Ks" [1 1 1] "float roughness" 0.2)");
  EXPECT_NEAR(b.f(kWo, kWi).x, book_torrance_sparrow(alpha, fresnel_dielectric(cos_half(), 1.5, 1)), 1e-6);
}

TEST_F(MaterialTest, MetalDefaultsToCopper) {
  const Bsdf b = bsdf(R"(Material "metal" "float roughness" 0.3 "bool remaproughness" false)");
  const double fresnel = fresnel_conductor(cos_half(), copper().eta.y, copper().k.y);
  EXPECT_NEAR(b.f(kWo, kWi).y, book_torrance_sparrow(0.3, fresnel), 1e-5);
}

TEST_F(MaterialTest, ConductorUsesTheSquareRootAndMayBeAMirror) {
  const Bsdf rough = bsdf(R"(Material "conductor" "spectrum eta" "metal-Al-eta" "spectrum k" "metal-Al-k"
    "float roughness" 0.09)");
  const Rgb eta = *named_spectrum("metal-Al-eta"), k = *named_spectrum("metal-Al-k");
  EXPECT_NEAR(rough.f(kWo, kWi).x, book_torrance_sparrow(0.3, fresnel_conductor(cos_half(), eta.x, k.x)),
              1e-5);
  EXPECT_FALSE(has_specular_);
  const Bsdf smooth = bsdf(R"(Material "conductor")");
  EXPECT_EQ(smooth.specular_count(), 1);
  EXPECT_FALSE(smooth.has_non_specular());
  EXPECT_TRUE(has_specular_);
}

TEST_F(MaterialTest, ConductorByReflectance) {
  const Bsdf b = bsdf(R"(Material "conductor" "rgb reflectance" [0.2 0.5 1])", Vec3f(0, 0, 1));
  const auto sample = b.sample_specular(Vec3f(0, 0, 1), 0);
  ASSERT_TRUE(sample);
  EXPECT_NEAR(sample->f.x, 0.2, 1e-6);
  EXPECT_NEAR(sample->f.y, 0.5, 1e-6);
  EXPECT_NEAR(sample->f.z, 1, 1e-3);
}

TEST_F(MaterialTest, Substrate) {
  const Bsdf b = bsdf(R"(Material "substrate" "rgb Kd" [0.5 0.5 0.5] "rgb Ks" [0.04 0.04 0.04]
    "float uroughness" 0.1 "float vroughness" 0.1 "bool remaproughness" false)");
  const auto weight = [](double c) { return 1 - std::pow(1 - c / 2, 5); };
  const Vec3d wh = (Vec3d(kWo) + Vec3d(kWi)).normalized();
  const double schlick = 0.04 + 0.96 * std::pow(1 - cos_half(), 5);
  const double expected = 28 / (23 * kPi) * 0.5 * 0.96 * weight(kWo.z) * weight(kWi.z) +
                          book_d(wh, 0.1) / (4 * cos_half() * std::max(kWo.z, kWi.z)) * schlick;
  EXPECT_NEAR(b.f(kWo, kWi).x, expected, 1e-5 * expected);
}

TEST_F(MaterialTest, UberIsOpacityTimesItsParts) {
  const Bsdf b = bsdf(R"(Material "uber" "rgb Kd" [0.4 0.4 0.4] "rgb Ks" [0.5 0.5 0.5] "rgb Kr" [0.1 0.1 0.1]
    "rgb Kt" [0.2 0.2 0.2] "rgb opacity" [0.75 0.75 0.75] "float roughness" 0.2 "bool remaproughness" false
    "float index" 1.3)");
  const double fresnel = fresnel_dielectric(cos_half(), 1, 1.3);
  EXPECT_NEAR(b.f(kWo, kWi).x, 0.75 * (0.4 / kPi + 0.5 * book_torrance_sparrow(0.2, fresnel)), 1e-6);
  ASSERT_EQ(b.specular_count(), 3);
  const auto straight = b.sample_specular(kWo, 0);
  ASSERT_TRUE(straight);
  EXPECT_NEAR((straight->wi + kWo).length(), 0, 1e-6);
  EXPECT_NEAR(straight->f.x * kWo.z, 0.25, 1e-6);
}

TEST_F(MaterialTest, UberWithoutAnythingIsAHole) {
  const Bsdf b = bsdf(R"(Material "uber" "rgb Kd" [0 0 0] "rgb Ks" [0 0 0] "rgb opacity" [0 0 0])");
  EXPECT_FALSE(b.has_non_specular());
  EXPECT_EQ(b.specular_count(), 1);
}

TEST_F(MaterialTest, GlassIsSmoothAtZeroRoughness) {
  const Bsdf smooth = bsdf(R"(Material "glass" "float index" 1.5 "bool remaproughness" false)");
  EXPECT_EQ(smooth.specular_count(), 2);
  EXPECT_TRUE(has_specular_);
  EXPECT_FALSE(smooth.transmits());
  const Bsdf rough = bsdf(R"(Material "glass" "float uroughness" 0.2 "float vroughness" 0.2)");
  EXPECT_EQ(rough.specular_count(), 0);
  EXPECT_FALSE(has_specular_);
  EXPECT_TRUE(rough.transmits());
  EXPECT_GT(rough.f(kWo, -kWo).x, 0);
}

TEST_F(MaterialTest, MirrorAndThinGlass) {
  const Bsdf mirror = bsdf(R"(Material "mirror")");
  EXPECT_NEAR(mirror.sample_specular(kWo, 0)->f.x * kWo.z, 0.9, 1e-6);
  const Bsdf thin = bsdf(R"(Material "thindielectric")", Vec3f(0, 0, 1));
  EXPECT_NEAR(thin.sample_specular(Vec3f(0, 0, 1), 0)->f.x, 2 * 0.04 / 1.04, 1e-6);
  EXPECT_NEAR(thin.sample_specular(Vec3f(0, 0, 1), 1)->f.x, 1 - 2 * 0.04 / 1.04, 1e-6);
}

TEST_F(MaterialTest, TranslucentSendsLightThrough) {
  const Bsdf b = bsdf(R"(Material "translucent" "rgb Kd" [0.8 0.8 0.8] "rgb Ks" [0 0 0])");
  EXPECT_TRUE(b.transmits());
  EXPECT_NEAR(b.f(kWo, kWi).x, 0.4 / kPi, 1e-6);
  EXPECT_NEAR(b.f(kWo, -kWi).x, 0.4 / kPi, 1e-6);
}

TEST_F(MaterialTest, MixWeightsTheFirstInV3AndTheSecondInV4) {
  const std::string two = R"(MakeNamedMaterial "a" "string type" "matte" "rgb Kd" [1 1 1]
    MakeNamedMaterial "b" "string type" "matte" "rgb Kd" [0 0 0] )";
  const double white = 1 / kPi;
  EXPECT_NEAR(bsdf(two + R"(Material "mix" "string namedmaterial1" "a" "string namedmaterial2" "b"
    "float amount" 0.25)")
                  .f(kWo, kWi)
                  .x,
              0.25 * white, 1e-6);
  EXPECT_NEAR(bsdf(two + R"(Material "mix" "string materials" ["a" "b"] "float amount" 0.25)").f(kWo, kWi).x,
              0.75 * white, 1e-6);
  EXPECT_NEAR(bsdf(two + R"(Material "mix" "string namedmaterial1" "a" "string namedmaterial2" "b"
    "rgb amount" [1 0.5 0])")
                  .f(kWo, kWi)
                  .y,
              0.5 * white, 1e-6);
}

TEST_F(MaterialTest, MixesThatCannotBe) {
  const std::string self = R"(MakeNamedMaterial "a" "string type" "mix" "string namedmaterial1" "b"
      "string namedmaterial2" "b"
    MakeNamedMaterial "b" "string type" "mix" "string namedmaterial1" "a" "string namedmaterial2" "a"
    NamedMaterial "b")";
  EXPECT_THAT(fault(self), AllOf(HasSubstr("scene.pbrt:"), HasSubstr("itself")));
  std::string many = "MakeNamedMaterial \"m0\" \"string type\" \"plastic\"\n";
  for (int i = 1; i <= 3; ++i) {
    const std::string before = "\"m" + std::to_string(i - 1) + "\"";
    many += "MakeNamedMaterial \"m" + std::to_string(i) +
            "\" \"string type\" \"mix\" \"string namedmaterial1\" " + before + " \"string namedmaterial2\" " +
            before + "\n";
  }
  EXPECT_THAT(fault(many + "NamedMaterial \"m3\""), HasSubstr("16 lobes"));
  EXPECT_TRUE(build(many + "NamedMaterial \"m2\"").ok());
}

TEST_F(MaterialTest, MixOfAnUnknownNameWarns) {
  const std::string text =
      R"(Material "mix" "string namedmaterial1" "nobody" "string namedmaterial2" "nobody")";
  EXPECT_NEAR(bsdf(text).f(kWo, kWi).x, 0.5 / kPi, 1e-6);
  EXPECT_THAT(warnings_, testing::Contains(HasSubstr("nobody")));
  EXPECT_FALSE(build(text, true).ok());
}

TEST_F(MaterialTest, Interface) {
  for (const char* text : {R"(Material "")", R"(Material "none")", R"(Material "interface")"}) {
    const auto materials = build(text);
    ASSERT_TRUE(materials.ok()) << materials.status();
    EXPECT_TRUE(materials->is_interface(last_)) << text;
  }
  EXPECT_FALSE(build(R"(Material "matte")")->is_interface(last_));
}

TEST_F(MaterialTest, TexturesAreFollowedAndMarked) {
  const std::string text = R"(Texture "unused" "spectrum" "constant" "rgb value" [1 1 1]
    Texture "a" "spectrum" "constant" "rgb value" [0.5 0.5 0.5]
    Texture "b" "spectrum" "scale" "texture tex1" "a" "rgb tex2" [0.5 0.5 0.5]
    Material "matte" "texture Kd" "b")";
  EXPECT_NEAR(bsdf(text).f(kWo, kWi).x, 0.25 / kPi, 1e-6);
  EXPECT_THAT(build(text)->used_textures(), ElementsAre(false, true, true));
}

TEST_F(MaterialTest, CoatedDiffuseSaysHowItDiffers) {
  const Bsdf b = bsdf(R"(Material "coateddiffuse" "rgb reflectance" [0.5 0.5 0.5])");
  EXPECT_EQ(b.specular_count(), 1);
  EXPECT_TRUE(b.has_non_specular());
  EXPECT_THAT(warnings_, ElementsAre(AllOf(HasSubstr("scene.pbrt:2:1"), HasSubstr("coateddiffuse"))));
}

TEST_F(MaterialTest, UnsupportedIsTheNearestWithAWarningOrAnError) {
  for (const char* type :
       {"disney", "subsurface", "kdsubsurface", "fourier", "measured", "coatedconductor"}) {
    const std::string text = "Material \"" + std::string(type) + "\"";
    const auto materials = build(text);
    EXPECT_TRUE(materials.ok()) << type << ": " << materials.status();
    EXPECT_THAT(warnings_, ElementsAre(AllOf(HasSubstr("scene.pbrt:2:1"), HasSubstr(type)))) << type;
    EXPECT_EQ(build(text, true).status().code(), absl::StatusCode::kInvalidArgument) << type;
  }
}

TEST_F(MaterialTest, AMissingSpectrumFileIsTheDefaultWithAWarning) {
  const std::string text = R"(Material "metal" "spectrum eta" "gone.spd" "float roughness" 0.3
    "bool remaproughness" false)";
  const double fresnel = fresnel_conductor(cos_half(), copper().eta.y, copper().k.y);
  EXPECT_NEAR(bsdf(text).f(kWo, kWi).y, book_torrance_sparrow(0.3, fresnel), 1e-5);
  EXPECT_THAT(warnings_, ElementsAre(AllOf(HasSubstr("scene.pbrt:2:"), HasSubstr("gone.spd"))));
  EXPECT_FALSE(build(text, true).ok());
}

TEST_F(MaterialTest, UnwornMaterialsSayNothing) {
  const auto materials = build(R"(MakeNamedMaterial "a" "string type" "disney"
    Material "matte")");
  ASSERT_TRUE(materials.ok());
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(MaterialTest, ValuesOutOfRangeNameTheirPlace) {
  EXPECT_THAT(fault(R"(Material "matte" "rgb Kd" [-1 0 0])"),
              AllOf(HasSubstr("scene.pbrt:2:"), HasSubstr("Kd")));
  EXPECT_THAT(fault(R"(Material "matte" "float sigma" 120)"), HasSubstr("sigma"));
  EXPECT_THAT(fault(R"(Material "plastic" "float roughness" -0.5)"), HasSubstr("roughness"));
  EXPECT_THAT(fault(R"(Material "glass" "float index" 0)"), HasSubstr("index"));
  EXPECT_THAT(fault(R"(Material "coateddiffuse" "float eta" 0.9)"), HasSubstr("eta"));
  EXPECT_THAT(fault(R"(Material "unobtainium")"),
              AllOf(HasSubstr("scene.pbrt:2:1"), HasSubstr("unobtainium")));
}

TEST_F(MaterialTest, TinyRoughnessStaysFinite) {
  for (const char* text :
       {R"(Material "metal" "float roughness" 0 "bool remaproughness" false)",
        R"(Material "substrate" "float uroughness" 1e-9 "float vroughness" 0 "bool remaproughness" false)",
        R"(Material "plastic" "float roughness" 0 "bool remaproughness" false)"}) {
    const Bsdf b = bsdf(text);
    const Vec3f mirrored(-kWo.x, -kWo.y, kWo.z);
    EXPECT_TRUE(std::isfinite(b.f(kWo, mirrored).x)) << text;
    EXPECT_GT(b.f(kWo, mirrored).x, 0) << text;
    for (double u = 0.05; u < 1; u += 0.1) {
      const auto sample = b.sample(kWo, {u, 0.3}, u);
      ASSERT_TRUE(sample) << text;
      EXPECT_TRUE(std::isfinite(sample->f.x) && std::isfinite(sample->pdf)) << text;
    }
  }
}

}  // namespace
}  // namespace penumbra

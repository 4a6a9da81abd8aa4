// What lobes each material has at a point; pbrt-v3 chapter 9, pbrt-v4 chapter 10.
#include <algorithm>
#include <cmath>

#include "worker/materials/material_kinds.h"

namespace penumbra {
namespace {

bool is_black(const Rgb& c) {
  return c.x == 0 && c.y == 0 && c.z == 0;
}

Rgb not_below_zero(const Rgb& c) {
  return {std::max(0.0f, c.x), std::max(0.0f, c.y), std::max(0.0f, c.z)};
}

/// α along one tangent, and the roughness it came from (0 means smooth).
struct Axis {
  double alpha = 0, roughness = 0;
};

Axis axis(const FloatValue& value, double constant_alpha, Remap remap, const ShadingContext& at) {
  if (value.texture < 0) return {constant_alpha, value.constant};
  const double roughness = std::max(0.0, at(value));
  return {alpha_of(roughness, remap), roughness};
}

struct Facets {
  TrowbridgeReitz distribution;
  bool smooth = false;  ///< a mirror in place of facets, where the material has one
};

bool is_smooth(Smooth rule, const Axis& u, const Axis& v) {
  switch (rule) {
    case Smooth::kNever:
      return false;
    case Smooth::kZeroRoughness:
      return u.roughness == 0 && v.roughness == 0;
    case Smooth::kLeastAlpha:  // alpha_of() has raised what is below to the bound itself
      return std::max(u.alpha, v.alpha) <= TrowbridgeReitz::kLeastAlpha;
  }
  return false;
}

Facets facets(const Roughness& r, const ShadingContext& at) {
  const Axis u = axis(r.u, r.constant_alpha_u, r.remap, at), v = axis(r.v, r.constant_alpha_v, r.remap, at);
  return {{u.alpha, v.alpha}, is_smooth(r.smooth, u, v)};
}

/// May it be smooth somewhere?
bool may_be_smooth(const Roughness& r) {
  if (r.u.texture >= 0 || r.v.texture >= 0) return r.smooth != Smooth::kNever;
  return is_smooth(r.smooth, {r.constant_alpha_u, r.u.constant}, {r.constant_alpha_v, r.v.constant});
}

void add_reflection(const Rgb& color, const Facets& at, const Fresnel& fresnel, const Rgb& scale,
                    Bsdf& bsdf) {
  if (is_black(color)) return;
  if (at.smooth) {
    bsdf.add(SpecularReflection{color, fresnel}, scale);
  } else {
    bsdf.add(MicrofacetReflection{color, at.distribution, fresnel}, scale);
  }
}

void add(const InterfaceMaterial&, const ShadingContext&, const Rgb&, Bsdf&) {}

void add(const MatteMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  const Rgb kd = at(m.kd);
  if (is_black(kd)) return;
  const double sigma = std::clamp(at(m.sigma), 0.0, 90.0);  // pbrt's range; constants were checked
  if (sigma == 0) {
    bsdf.add(Lambert{kd}, scale);
  } else {
    bsdf.add(oren_nayar(kd, sigma), scale);
  }
}

// pbrt-v3's plastic has its indices the wrong way round: 1.5 on the outside, so that facets reflect all
// light beyond the critical angle. Its scenes and the papers' images are made with that; so are ours.
void add(const PlasticMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  if (const Rgb kd = at(m.kd); !is_black(kd)) bsdf.add(Lambert{kd}, scale);
  if (const Rgb ks = at(m.ks); !is_black(ks)) {
    bsdf.add(MicrofacetReflection{ks, facets(m.roughness, at).distribution, FresnelDielectric{1.5, 1}},
             scale);
  }
}

void add(const MetalMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  add_reflection(Rgb(1), facets(m.roughness, at), FresnelConductor{at(m.eta), at(m.k)}, scale, bsdf);
}

// η = 1 and k = 2 √(r/(1-r)) reflect r at normal incidence. r is kept below 1, where k is infinite, by
// the spacing of floats there.
void add(const ReflectanceMetalMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  const Rgb r = at(m.reflectance);
  Rgb k;
  for (int i = 0; i < 3; ++i) {
    const float below_one = std::min(r[i], 1 - 0x1p-24f);
    k[i] = 2 * std::sqrt(below_one / (1 - below_one));
  }
  add_reflection(Rgb(1), facets(m.roughness, at), FresnelConductor{Rgb(1), k}, scale, bsdf);
}

void add(const SubstrateMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  const Rgb kd = at(m.kd), ks = at(m.ks);
  if (is_black(kd) && is_black(ks)) return;
  bsdf.add(FresnelBlend{kd, ks, facets(m.roughness, at).distribution}, scale);
}

void add(const UberMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  const double eta = at(m.eta);
  const Rgb opacity = at(m.opacity), open = not_below_zero(Rgb(1) - opacity);
  if (!is_black(open)) bsdf.add(SpecularTransmission{open, 1, 1}, scale);
  if (const Rgb kd = opacity * at(m.kd); !is_black(kd)) bsdf.add(Lambert{kd}, scale);
  const Fresnel fresnel = FresnelDielectric{1, eta};
  if (const Rgb ks = opacity * at(m.ks); !is_black(ks)) {
    bsdf.add(MicrofacetReflection{ks, facets(m.roughness, at).distribution, fresnel}, scale);
  }
  if (const Rgb kr = opacity * at(m.kr); !is_black(kr)) bsdf.add(SpecularReflection{kr, fresnel}, scale);
  if (const Rgb kt = opacity * at(m.kt); !is_black(kt)) bsdf.add(SpecularTransmission{kt, 1, eta}, scale);
}

void add(const MirrorMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  if (const Rgb kr = at(m.kr); !is_black(kr)) bsdf.add(SpecularReflection{kr, FresnelNone{}}, scale);
}

void add(const GlassMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  const double eta = at(m.eta);
  const Facets f = facets(m.roughness, at);
  add_reflection(at(m.kr), f, FresnelDielectric{1, eta}, scale, bsdf);
  const Rgb kt = at(m.kt);
  if (is_black(kt)) return;
  if (f.smooth) {
    bsdf.add(SpecularTransmission{kt, 1, eta}, scale);
  } else {
    bsdf.add(MicrofacetTransmission{kt, f.distribution, 1, eta}, scale);
  }
}

// Two parallel interfaces, all orders of reflection between them: R' = R + T²R/(1 - R²) = 2R/(1 + R), and
// the rest goes straight on (pbrt-v4 §9.5.1).
void add(const ThinGlassMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  const double cos_o = std::abs(at.point.wo ^ bsdf.ns());
  const double once = fresnel_dielectric(cos_o, 1, at(m.eta));
  const double all = 2 * once / (1 + once);
  bsdf.add(SpecularReflection{Rgb(static_cast<float>(all)), FresnelNone{}}, scale);
  bsdf.add(SpecularTransmission{Rgb(static_cast<float>(1 - all)), 1, 1}, scale);
}

void add(const TranslucentMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  constexpr double kEta = 1.5;
  const Rgb reflect = at(m.reflect), transmit = at(m.transmit);
  const Rgb kd = at(m.kd), ks = at(m.ks);
  if (const Rgb r = reflect * kd; !is_black(r)) bsdf.add(Lambert{r}, scale);
  if (const Rgb t = transmit * kd; !is_black(t)) bsdf.add(LambertTransmission{t}, scale);
  if (is_black(ks)) return;
  const TrowbridgeReitz d = facets(m.roughness, at).distribution;
  if (const Rgb r = reflect * ks; !is_black(r)) {
    bsdf.add(MicrofacetReflection{r, d, FresnelDielectric{1, kEta}}, scale);
  }
  if (const Rgb t = transmit * ks; !is_black(t)) bsdf.add(MicrofacetTransmission{t, d, 1, kEta}, scale);
}

void add(const CoatedDiffuseMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  const double eta = at(m.eta);
  if (const Rgb base = at(m.reflectance); !is_black(base)) bsdf.add(coated_lambert(base, eta), scale);
  add_reflection(Rgb(1), facets(m.roughness, at), FresnelDielectric{1, eta}, scale, bsdf);
}

// Where the hair was hit is v across it: pbrt's curves have it, and so does any surface that is given such
// uv.
void add(const HairMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  const double beta_n = std::clamp(at(m.beta_n), 0.0, 1.0), beta_m = std::clamp(at(m.beta_m), 0.0, 1.0);
  Vec3f sigma_a;
  switch (m.pigment) {
    case HairMaterial::Pigment::kAbsorption: {
      const Rgb tint = at(m.tint);
      sigma_a = {tint.x, tint.y, tint.z};
      break;
    }
    case HairMaterial::Pigment::kColor:
      sigma_a = hair_absorption_of(at(m.tint), beta_n);
      break;
    case HairMaterial::Pigment::kMelanin:
      sigma_a = hair_absorption_of_melanin(std::max(0.0, at(m.eumelanin)), std::max(0.0, at(m.pheomelanin)));
      break;
  }
  const double eta = std::max(1.0, at(m.eta));
  bsdf.add(hair_fibre(sigma_a, 2 * double{at.point.uv.y} - 1, eta, beta_m, beta_n, at(m.alpha)), scale);
}

void add(const MixMaterial& m, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  const Rgb amount = at(m.amount);
  const auto kind_of = [&](int i) -> const MaterialKind& {
    return i < 0 ? default_material().kind : at.materials[i].kind;
  };
  add_lobes(kind_of(m.first), at, scale * amount, bsdf);
  add_lobes(kind_of(m.second), at, scale * not_below_zero(Rgb(1) - amount), bsdf);
}

LobeBounds bounds(const InterfaceMaterial&) {
  return {0, false};
}
LobeBounds bounds(const MatteMaterial&) {
  return {1, false};
}
LobeBounds bounds(const PlasticMaterial&) {
  return {2, false};
}
LobeBounds bounds(const MetalMaterial& m) {
  return {1, may_be_smooth(m.roughness)};
}
LobeBounds bounds(const ReflectanceMetalMaterial& m) {
  return {1, may_be_smooth(m.roughness)};
}
LobeBounds bounds(const SubstrateMaterial&) {
  return {1, false};
}
LobeBounds bounds(const UberMaterial& m) {
  const auto may_shine = [](const RgbValue& v) { return v.texture >= 0 || !is_black(v.constant); };
  const bool open = m.opacity.texture >= 0 || m.opacity.constant != Rgb(1);
  const bool kr = may_shine(m.kr), kt = may_shine(m.kt);
  return {2 + open + kr + kt, open || kr || kt};
}
LobeBounds bounds(const MirrorMaterial&) {
  return {1, true};
}
LobeBounds bounds(const GlassMaterial& m) {
  return {2, may_be_smooth(m.roughness)};
}
LobeBounds bounds(const ThinGlassMaterial&) {
  return {2, true};
}
LobeBounds bounds(const TranslucentMaterial&) {
  return {4, false};
}
LobeBounds bounds(const HairMaterial&) {
  return {1, false};
}
LobeBounds bounds(const CoatedDiffuseMaterial& m) {
  return {2, may_be_smooth(m.roughness)};
}

}  // namespace

double alpha_of(double roughness, Remap remap) {
  const double alpha = remap == Remap::kV3   ? alpha_of_roughness_v3(roughness)
                       : remap == Remap::kV4 ? alpha_of_roughness_v4(roughness)
                                             : roughness;
  return std::max(alpha, TrowbridgeReitz::kLeastAlpha);
}

Rgb ShadingContext::operator()(const RgbValue& value) const {
  return value.texture < 0 ? value.constant : not_below_zero(textures.evaluate(value, point));
}

void add_lobes(const MaterialKind& kind, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf) {
  std::visit([&](const auto& m) { add(m, at, scale, bsdf); }, kind);
}

LobeBounds lobe_bounds(const MaterialKind& kind, const std::vector<LobeBounds>& known) {
  return std::visit(
      [&](const auto& m) -> LobeBounds {
        if constexpr (std::is_same_v<std::decay_t<decltype(m)>, MixMaterial>) {
          const LobeBounds matte = bounds(MatteMaterial{});
          const LobeBounds& a = m.first < 0 ? matte : known[m.first];
          const LobeBounds& b = m.second < 0 ? matte : known[m.second];
          return {a.lobes + b.lobes, a.specular || b.specular, 1 + a.evaluations + b.evaluations};
        } else {
          return bounds(m);
        }
      },
      kind);
}

const Material& default_material() {
  static const Material material{MatteMaterial{{Rgb(0.5f)}, {0}}, {}, nullptr};
  return material;
}

}  // namespace penumbra

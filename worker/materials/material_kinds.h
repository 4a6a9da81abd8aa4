#pragma once
// The closed set of materials: their parameters, and what lobes they make of them at a point. The defaults
// are pbrt's and are set in material_builder.cpp.
//
// A new material needs its struct and name here, an overload of add_lobes() in material_lobes.cpp, a
// builder in material_builder.cpp.
#include <memory>
#include <variant>
#include <vector>

#include "worker/materials/bsdf.h"
#include "worker/textures/image.h"
#include "worker/textures/textures.h"

namespace penumbra {

/// What a roughness is to the microfacet distribution: α itself, or a perceptual value that pbrt maps to α.
enum class Remap { kDirect, kV3, kV4 };

/// Where a rough material is a smooth one: v3's metals and plastics never, its glass at roughness 0, v4's
/// materials where α is below what facets can resolve.
enum class Smooth { kNever, kZeroRoughness, kLeastAlpha };

/// Roughness along the two tangents. A constant's α is known once and for all.
struct Roughness {
  FloatValue u, v;
  Remap remap = Remap::kDirect;
  Smooth smooth = Smooth::kNever;
  double constant_alpha_u = 0, constant_alpha_v = 0;  ///< where u, v have no texture
};

struct InterfaceMaterial {};  ///< the surface is not there
struct MatteMaterial {
  RgbValue kd;
  FloatValue sigma;  ///< Oren–Nayar's, degrees
};
struct PlasticMaterial {
  RgbValue kd, ks;
  Roughness roughness;
};
struct MetalMaterial {
  RgbValue eta, k;
  Roughness roughness;
};
/// v4's conductor given by its reflectance at normal incidence.
struct ReflectanceMetalMaterial {
  RgbValue reflectance;
  Roughness roughness;
};
struct SubstrateMaterial {
  RgbValue kd, ks;
  Roughness roughness;
};
struct UberMaterial {
  RgbValue kd, ks, kr, kt, opacity;
  FloatValue eta;
  Roughness roughness;
};
struct MirrorMaterial {
  RgbValue kr;
};
struct GlassMaterial {
  RgbValue kr, kt;
  FloatValue eta;
  Roughness roughness;
};
struct ThinGlassMaterial {
  FloatValue eta;
};
struct TranslucentMaterial {
  RgbValue kd, ks, reflect, transmit;
  Roughness roughness;
};
struct CoatedDiffuseMaterial {
  RgbValue reflectance;
  FloatValue eta;
  Roughness roughness;
};
/// Absorption by one of three: itself, a colour, melanin.
struct HairMaterial {
  enum class Pigment { kAbsorption, kColor, kMelanin } pigment = Pigment::kMelanin;
  RgbValue tint;  ///< absorption or colour
  FloatValue eumelanin, pheomelanin;
  FloatValue eta, beta_m, beta_n;
  FloatValue alpha;  ///< of the scales, degrees
};
/// Lobes of two materials, the first weighted by `amount` and the second by 1 - amount (pbrt-v3; v4 counts
/// from the other end, which the builder turns round).
struct MixMaterial {
  int first = -1, second = -1;  ///< indices of materials; -1: the default matte
  RgbValue amount;
};

using MaterialKind =
    std::variant<InterfaceMaterial, MatteMaterial, PlasticMaterial, MetalMaterial, ReflectanceMetalMaterial,
                 SubstrateMaterial, UberMaterial, MirrorMaterial, GlassMaterial, ThinGlassMaterial,
                 TranslucentMaterial, CoatedDiffuseMaterial, HairMaterial, MixMaterial>;

/// A material and what changes its shading normal.
struct Material {
  MaterialKind kind;
  FloatValue bump;  ///< displacement along the normal, scene units; a constant is none
  std::shared_ptr<const Image> normal_map;  ///< v4: replaces the bump
  bool displaced() const { return bump.texture >= 0 || normal_map != nullptr; }
};

/// The materials of a scene and where they are being evaluated.
struct ShadingContext {
  const std::vector<Material>& materials;
  const SurfacePoint& point;
  const Textures& textures;
  Rgb operator()(const RgbValue& value) const;  ///< not below 0: filters of signed images may ring
  double operator()(const FloatValue& value) const { return textures.evaluate(value, point); }
};

/// Adds a material's lobes, each times `scale`.
void add_lobes(const MaterialKind& kind, const ShadingContext& at, const Rgb& scale, Bsdf& bsdf);

/// The most lobes that a material can add, whether one of them may be specular, and how many materials are
/// evaluated for it, its own included.
struct LobeBounds {
  int lobes = 0;
  bool specular = false;
  int evaluations = 1;
};
/// `known`: bounds of all materials that it mixes.
LobeBounds lobe_bounds(const MaterialKind& kind, const std::vector<LobeBounds>& known);

/// pbrt's default: matte, Kd 0.5.
const Material& default_material();

/// α of a constant roughness under a remapping, at least TrowbridgeReitz::kLeastAlpha.
double alpha_of(double roughness, Remap remap);

}  // namespace penumbra

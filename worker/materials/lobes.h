#pragma once
// The closed set of lobes. Directions are unit, in the shading frame (local_frame.h), away from the
// surface; f is per solid angle, without the cosine; densities are sr⁻¹. Bsdf asks only for directions whose
// cosines, to the shading and to the geometric normal, are at least kLeastCosine, and asks a reflecting lobe
// only for pairs on one side of the geometric surface: so no lobe divides by zero.
//
// A new lobe needs a file of its own, its name here, and
//   kSpecular   a Dirac lobe: scatter(lobe, wo); else f(), pdf(), sample()
//   kTransmits  serves pairs on opposite sides of the geometric surface; else on the same side
//   kFolds      f is also non-zero between the shading and the geometric horizon: see Bsdf::pdf
#include <type_traits>
#include <variant>

#include "worker/materials/coated_lambert.h"
#include "worker/materials/fresnel_blend.h"
#include "worker/materials/hair_fibre.h"
#include "worker/materials/lambert.h"
#include "worker/materials/lambert_transmission.h"
#include "worker/materials/microfacet_reflection.h"
#include "worker/materials/microfacet_transmission.h"
#include "worker/materials/oren_nayar.h"
#include "worker/materials/specular_reflection.h"
#include "worker/materials/specular_transmission.h"

namespace penumbra {

using Lobe =
    std::variant<Lambert, OrenNayar, LambertTransmission, MicrofacetReflection, MicrofacetTransmission,
                 FresnelBlend, CoatedLambert, SpecularReflection, SpecularTransmission, HairFibre>;

/// A fibre serves every pair of directions, and its samples take a third number.
template <class L>
constexpr bool kFibre = std::is_same_v<L, HairFibre>;

}  // namespace penumbra

#pragma once
// The numbers of pbrt's material `hair` and what they may be: the client refuses others before anything is
// started, the worker reads them by the same table.
#include <span>
#include <string_view>

#include "absl/status/status.h"
#include "scenes/description.h"

namespace penumbra {

struct HairNumber {
  std::string_view name;
  float least, most;  ///< both inclusive
};

/// Chiang, Bitterli, Tappan & Burley 2016: roughnesses in [0,1]; the scales' angle in degrees, at most a
/// right one; pigments as concentrations; a fibre is not thinner, optically, than the air around it.
std::span<const HairNumber> hair_numbers();

/// InvalidArgument, `file:line:column: …`, of the first number out of its range. Textures are not looked
/// into.
absl::Status check_hair(const MaterialEntity& material, const SceneDescription& description);

}  // namespace penumbra

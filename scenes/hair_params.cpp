#include "scenes/hair_params.h"

#include <limits>

#include "proto/status.h"

namespace penumbra {

std::span<const HairNumber> hair_numbers() {
  constexpr float kUnbounded = std::numeric_limits<float>::max();
  static constexpr HairNumber kNumbers[] = {{"eumelanin", 0, kUnbounded},
                                            {"pheomelanin", 0, kUnbounded},
                                            {"eta", 1, kUnbounded},
                                            {"beta_m", 0, 1},
                                            {"beta_n", 0, 1},
                                            {"alpha", -90, 90}};
  return kNumbers;
}

absl::Status check_hair(const MaterialEntity& material, const SceneDescription& description) {
  if (material.type != "hair") return absl::OkStatus();
  for (const HairNumber& number : hair_numbers()) {
    const Param* const param = material.params.find(number.name);
    if (param == nullptr || param->type == "texture") continue;
    const auto value = static_cast<float>(material.params.number(number.name, number.least));
    if (!(value >= number.least && value <= number.most))
      return invalid_input("{}: {} {} is not in [{}, {}]", description.place(param->loc), number.name, value,
                           number.least, number.most);
  }
  return absl::OkStatus();
}

}  // namespace penumbra

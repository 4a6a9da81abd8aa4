#include "scenes/description.h"

#include <cmath>

#include "scenes/diagnostics.h"

namespace penumbra {

const Param* Params::find(std::string_view name) const {
  for (auto param = all.rbegin(); param != all.rend(); ++param)
    if (param->name == name) return &*param;
  return nullptr;
}

double Params::number(std::string_view name, double fallback) const {
  const Param* const param = find(name);
  if (!param || (param->type != "float" && param->type != "integer") || param->numbers.empty())
    return fallback;
  return param->numbers[0];
}

int64_t Params::integer(std::string_view name, int64_t fallback) const {
  const Param* const param = find(name);
  if (!param || param->type != "integer" || param->numbers.empty()) return fallback;
  // The parser has made sure that integers fit 32 bits.
  return static_cast<int64_t>(param->numbers[0]);
}

bool Params::boolean(std::string_view name, bool fallback) const {
  const Param* const param = find(name);
  return param && param->type == "bool" && !param->bools.empty() ? param->bools[0] != 0 : fallback;
}

std::string Params::string(std::string_view name, std::string_view fallback) const {
  const Param* const param = find(name);
  if (!param || param->type != "string" || param->strings.empty()) return std::string(fallback);
  return param->strings[0];
}

std::string SceneDescription::place(FileLoc loc) const {
  return place_in(files, loc);
}

}  // namespace penumbra

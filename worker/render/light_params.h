#pragma once
// Readers of parameters that several builders of the scene need.
#include <string_view>

#include "scenes/description.h"

namespace penumbra {

/// A point or vector parameter, or the fallback where it is absent.
inline Vec3d vector_param(const Params& params, std::string_view name, const Vec3d& fallback = Vec3d(0)) {
  const Param* p = params.find(name);
  return p && p->numbers.size() == 3 ? Vec3d(p->numbers[0], p->numbers[1], p->numbers[2]) : fallback;
}

inline Vec3d transform_point(const Matrix& m, const Vec3d& p) {
  Vec3d out;
  m.multVecMatrix(p, out);
  return out;
}
inline Vec3d transform_direction(const Matrix& m, const Vec3d& d) {
  Vec3d out;
  m.multDirMatrix(d, out);
  return out;
}

/// Multiplies by the light's `scale`: one number (v3 and v4) or a colour (v3).
inline void apply_scale(const Params& params, Rgb& value) {
  const Param* scale = params.find("scale");
  if (scale && scale->numbers.size() >= 3)
    value *= Rgb(float(scale->numbers[0]), float(scale->numbers[1]), float(scale->numbers[2]));
  else
    value *= float(params.number("scale", 1));
}

}  // namespace penumbra

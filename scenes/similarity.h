#pragma once
// Whether a transform keeps angles: what is round under it, and equal solid angles, stay so.
#include "scenes/math.h"

namespace penumbra {

/// `scale`: the length of the first transformed unit axis.
bool is_similarity(const Matrix& m, double& scale);

}  // namespace penumbra

#pragma once
#include "worker/textures/pyramid.h"

namespace penumbra {

/// The next level: half as wide and high (rounded down, at least 1), each value the mean over the exact
/// area it covers, so that every level has the image's mean whatever the size.
Texels halved(const Texels& texels);

}  // namespace penumbra

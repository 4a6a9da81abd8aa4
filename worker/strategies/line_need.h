#pragma once
// Whether a mix asks the geometry for lines or shafts at all.
#include "proto/mix.h"
#include "worker/strategies/light_set.h"

namespace penumbra {

/// Fewer shadow rays than these towards one light cost less than a shaft (geometry/README.md: measured).
constexpr int kLeastShaftRays = 16;

/// False: nothing that the mix does walks the line hierarchy, and it need not be built. May be true for a mix
/// that does not, either.
bool needs_line_hierarchy(const Mix& mix, const LightSet& lights);

}  // namespace penumbra

// Line queries against other roads to the same answer: every triangle in extended precision, rays, closed
// surfaces, moved and scaled scenes.
#include <gtest/gtest.h>

#include "tests/unit/geometry/random_scenes.h"

namespace penumbra::testing {
namespace {}  // namespace
}  // namespace penumbra::testing

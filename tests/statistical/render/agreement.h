#pragma once
// Every strategy against every other: they estimate the same picture by different roads, so their block means
// must agree.
#include <optional>
#include <string>
#include <vector>

#include "tests/support/render.h"

namespace penumbra::test {

struct AgreementSpec {
  int width = 64, height = 48;
  int64_t passes = 64, group = 1;
  int tile = 64;
  SamplerKind sampler = SamplerKind::kIndependent;
  std::optional<Transient> transient = {};  ///< then every bin is compared as well
  PixelRect crop{0, 0, 0, 0};               ///< where the pictures are compared; empty: everywhere
};

/// Renders the mixes, expects no value that is not finite, and z-tests the block means of all pairs of mixes
/// (Šidák over all pairs, blocks and channels, 0.001 that any rightful picture fails).
void expect_agreement(const ScenePtr& scene, const std::vector<std::string>& mixes, const AgreementSpec& how);

}  // namespace penumbra::test

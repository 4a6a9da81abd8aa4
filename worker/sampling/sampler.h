#pragma once
// Counter-based random numbers: a number is a pure function of its key, so an image depends on pass
// counts and seed, never on the order or the place in which passes are made.
#include <cstdint>

#include "proto/job.h"
#include "scenes/math.h"

namespace penumbra {

/// Philox4x32-10 (Salmon et al. 2011) of a 128-bit counter under a 64-bit key.
struct Random4 {
  uint32_t x[4];
};
Random4 philox(uint64_t key, uint64_t counter_lo, uint64_t counter_hi);

/// 53-bit uniform in [0,1) from 64 random bits; never 1.
inline double uniform(uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// Every random number of one pixel in one pass of one mix. Copy freely: 24 bytes, no state.
class PassSampler {
 public:
  /// `group`: passes per independently scrambled group (>= 1); stratification spans a group, never two. The
  /// samples of one strategy in a group are fewer than 2^32.
  PassSampler(SamplerKind kind, uint64_t seed, uint32_t mix, TaskKind stage, uint32_t pixel, int64_t pass,
              int64_t group);

  /// Position in the pixel's filter: u in [0,1)².
  Vec2d film() const;
  /// Position i of n for what is looked at more often than the rest: stratified together, and over the passes
  /// of the group.
  Vec2d film(int i, int n) const;
  /// For ray i of n through the lens: a point of it, or a chord; streams of different n are independent.
  Vec2d lens(int i, int n) const;
  /// A third number for the same ray: where on the chord.
  double along_lens(int i, int n) const;
  /// When, for the same ray: u in [0,1) of the shutter.
  double time(int i, int n) const;
  /// Where a pass sends several rays: the numbers of all that happens along ray i. Those of ray 0 are this
  /// sampler's own.
  PassSampler branch(int i) const;

  /// Sample i of n of a strategy (`slot`: its place in the mix) for one light at path vertex `depth`.
  /// The n samples of a pass, and those of all passes of a group, are stratified together in 2D.
  Vec2d light(int depth, uint32_t light, int slot, int i, int n) const;
  /// A third number for the same sample: which lobe, which part of the light.
  double choice(int depth, uint32_t light, int slot, int i, int n) const;
  /// The same for a strategy that takes one number: stratified in one dimension.
  double line(int depth, uint32_t light, int slot, int i, int n) const;
  /// For drawing n lights in a pass: stratified over them and over the passes of a group.
  double draw(int depth, int i, int n) const;
  /// For specular branches; `i` counts the uses.
  double select(int depth, int i) const;

 private:
  /// How many samples of n a pass the group has; i must be one of them.
  uint32_t samples_of_group(int i, int n) const;
  /// Sample i of n of this pass, of a stream stratified over the passes of the group.
  Vec2d square(uint64_t stream, int i, int n) const;
  double segment(uint64_t stream, int i, int n) const;

  SamplerKind kind_;
  uint64_t key_;  ///< of (seed, mix, stage, pixel, group)
  uint32_t pass_in_group_, group_size_;
};

}  // namespace penumbra

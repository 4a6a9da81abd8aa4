#include "worker/sampling/sampler.h"

#include "proto/status.h"
#include "worker/sampling/hash.h"
#include "worker/sampling/patterns.h"

namespace penumbra {
namespace {

// Patterns count the samples of a strategy in a group in 32 bits.
constexpr int64_t kMostSamples = (int64_t{1} << 32) - 1;

// What a stream of numbers is for; part of its key.
enum class Use : uint32_t {
  kFilm,
  kLens,
  kTime,
  kLight,
  kChoice,
  kSelect,
  kFilmAgain,
  kLine,
  kDraw,
  kAlongLens,
  kBranch
};

/// Key of one stream of a pixel and group. `a` and `b` number the streams of a use.
uint64_t stream_key(uint64_t key, Use use, uint64_t a = 0, uint64_t b = 0) {
  return child_key(child_key(key + a, b), static_cast<uint64_t>(use));
}

/// Sample i of n in pass p of g passes, as one of n·g strata such that the n samples of a pass fall into n
/// different blocks of g neighbours, and the g passes of a block into different members of it. For every
/// pass i -> block is a bijection, for every block p -> member is one: together one of all n·g.
uint32_t nested_stratum(uint32_t p, uint32_t g, uint32_t i, uint32_t n, uint64_t seed) {
  const uint64_t own = ~seed;  // the pattern's children are of the seed itself
  const uint32_t block = n == 1 ? 0 : permute(i, n, child_key(own, 2 * uint64_t{p}));
  const uint32_t member = g == 1 ? 0 : permute(p, g, child_key(own, 2 * uint64_t{block} + 1));
  return block * g + member;
}

}  // namespace

PassSampler::PassSampler(SamplerKind kind, uint64_t seed, uint32_t mix, TaskKind stage, uint32_t pixel,
                         int64_t pass, int64_t group)
    : kind_(kind) {
  PENUMBRA_CHECK(pass >= 0 && group >= 1 && group <= kMostSamples);
  group_size_ = static_cast<uint32_t>(group);
  pass_in_group_ = static_cast<uint32_t>(pass % group);
  const uint64_t group_index = static_cast<uint64_t>(pass / group);
  const uint64_t stage_bit = stage == TaskKind::kPilot ? 1 : 0;
  const Random4 r = philox(seed, uint64_t{pixel} << 32 | mix, group_index << 1 | stage_bit);
  key_ = uint64_t{r.x[1]} << 32 | r.x[0];
}

uint32_t PassSampler::samples_of_group(int i, int n) const {
  PENUMBRA_CHECK(0 <= i && i < n && int64_t{group_size_} * n <= kMostSamples);
  return group_size_ * static_cast<uint32_t>(n);
}

Vec2d PassSampler::square(uint64_t stream, int i, int n) const {
  const uint32_t size = samples_of_group(i, n), index = pass_in_group_ * n + i;
  switch (kind_) {
    case SamplerKind::kIndependent: {
      const uint64_t bits = child_key(stream, index);
      return {uniform(bits), uniform(mix64(bits ^ stream))};
    }
    case SamplerKind::kStratified:
      return multi_jitter(nested_stratum(pass_in_group_, group_size_, i, n, stream), size, stream);
    case SamplerKind::kSobol:
      return scrambled_sobol(index, stream);
  }
  PENUMBRA_CHECK(false);
}

double PassSampler::segment(uint64_t stream, int i, int n) const {
  const uint32_t size = samples_of_group(i, n), index = pass_in_group_ * n + i;
  switch (kind_) {
    case SamplerKind::kIndependent:
      return uniform(child_key(stream, index));
    case SamplerKind::kStratified:
      return jitter(nested_stratum(pass_in_group_, group_size_, i, n, stream), size, stream);
    case SamplerKind::kSobol:
      return scrambled_van_der_corput(index, stream);
  }
  PENUMBRA_CHECK(false);
}

Vec2d PassSampler::film() const {
  return square(stream_key(key_, Use::kFilm), 0, 1);
}
Vec2d PassSampler::film(int i, int n) const {
  return square(stream_key(key_, Use::kFilmAgain), i, n);
}
Vec2d PassSampler::lens(int i, int n) const {
  return square(stream_key(key_, Use::kLens, static_cast<uint32_t>(n)), i, n);
}
double PassSampler::along_lens(int i, int n) const {
  return segment(stream_key(key_, Use::kAlongLens, static_cast<uint32_t>(n)), i, n);
}
PassSampler PassSampler::branch(int i) const {
  PassSampler own = *this;
  if (i > 0) own.key_ = stream_key(key_, Use::kBranch, static_cast<uint64_t>(i));
  return own;
}
double PassSampler::time(int i, int n) const {
  return segment(stream_key(key_, Use::kTime, static_cast<uint32_t>(n)), i, n);
}

namespace {

uint64_t light_key(uint64_t key, Use use, int depth, uint32_t light, int slot) {
  return stream_key(key, use, uint64_t{light} << 32 | static_cast<uint32_t>(depth),
                    static_cast<uint64_t>(slot));
}

}  // namespace

Vec2d PassSampler::light(int depth, uint32_t light, int slot, int i, int n) const {
  return square(light_key(key_, Use::kLight, depth, light, slot), i, n);
}

double PassSampler::choice(int depth, uint32_t light, int slot, int i, int n) const {
  return segment(light_key(key_, Use::kChoice, depth, light, slot), i, n);
}

double PassSampler::line(int depth, uint32_t light, int slot, int i, int n) const {
  return segment(light_key(key_, Use::kLine, depth, light, slot), i, n);
}

double PassSampler::draw(int depth, int i, int n) const {
  return segment(stream_key(key_, Use::kDraw, static_cast<uint32_t>(depth)), i, n);
}

double PassSampler::select(int depth, int i) const {
  return segment(stream_key(key_, Use::kSelect, static_cast<uint32_t>(depth), static_cast<uint64_t>(i)), 0,
                 1);
}

}  // namespace penumbra

#include "worker/sampling/patterns.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "worker/sampling/hash.h"
#include "worker/sampling/sampler.h"

namespace penumbra {
namespace {

// A jittered place in the last stratum may round up to 1.
constexpr double kBelowOne = 1 - 0x1p-53;

/// Uniform integer in [0,size) from 32 random bits (a multiplication instead of a remainder).
uint32_t scale_down(uint32_t bits, uint32_t size) {
  return static_cast<uint32_t>((uint64_t{bits} * size) >> 32);
}

uint32_t reverse_bits(uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  return __builtin_bswap32(x);
}

/// Nested uniform scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it,
/// because a multiplication by an even number carries upwards only (Laine & Karras 2011, constants of
/// Burley 2020, listing 2).
uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return x;
}

/// Second dimension of Sobol's sequence, bit-reversed. Its generator matrix is Pascal's triangle mod 2, and
/// by Lucas' theorem C(j,i) is odd exactly if the bits of i are among those of j: so bit i of the result is
/// the parity of the bits j ⊇ i of the index, a sum over supersets, one step per bit of a bit's number.
uint32_t sobol_second_reversed(uint32_t index) {
  index ^= (index >> 1) & 0x55555555u;
  index ^= (index >> 2) & 0x33333333u;
  index ^= (index >> 4) & 0x0f0f0f0fu;
  index ^= (index >> 8) & 0x00ff00ffu;
  index ^= (index >> 16) & 0x0000ffffu;
  return index;
}

/// 32 leading bits from the sequence, 21 random ones behind them.
double to_unit(uint32_t leading, uint64_t trailing) {
  return uniform((uint64_t{leading} << 32) | (trailing & 0xffffffffu));
}

}  // namespace

uint32_t permute(uint32_t i, uint32_t size, uint64_t seed) {
  if (size == 1) return 0;
  const uint32_t mask = ~uint32_t{0} >> std::countl_zero(size - 1);
  const int half = (std::bit_width(mask) + 1) / 2;
  const uint64_t adds = seed, factors = std::rotl(seed, 8);
  // A bijection of [0, 2^k), repeated until it is back inside [0,size): still a bijection there. Each round
  // takes other bits of the keys, for where k is small only the lowest few of a key do anything.
  do {
    for (int round = 0; round < 64; round += 16) {
      i = ((i + static_cast<uint32_t>(adds >> round)) * (static_cast<uint32_t>(factors >> round) | 1)) & mask;
      i ^= i >> half;
    }
  } while (i >= size);
  // The rotation makes the image of every i uniform over the seeds, even for sizes so small that the
  // bijections above are far from all permutations.
  const uint32_t rotation = scale_down(static_cast<uint32_t>(mix64(seed)), size), room = size - rotation;
  return i < room ? i + rotation : i - room;
}

Vec2d multi_jitter(uint32_t stratum, uint32_t size, uint64_t seed) {
  const uint32_t columns = static_cast<uint32_t>(std::sqrt(static_cast<double>(size)));
  const uint32_t rows = size / columns + (size % columns != 0);
  // Which column a sample of a row takes, and which part of the column it is in, are drawn for each row and
  // for each column apart. Permutations common to all of them (Kensler 2013) leave the errors of all cells of
  // a row alike: for f = xy the variance then falls with the power −1.5 of the size, here with −2.
  const uint32_t row = stratum / columns;
  const uint32_t column = permute(stratum % columns, columns, child_key(child_key(seed, 0), row));
  const uint32_t part = permute(row, rows, child_key(child_key(seed, 1), column));
  const uint64_t own = child_key(seed, uint64_t{4} + stratum);
  const double jx = static_cast<uint32_t>(own) * 0x1p-32, jy = (own >> 32) * 0x1p-32;
  const double x = (column + (part + jx) / rows) / columns, y = (stratum + jy) / size;
  return {std::min(x, kBelowOne), std::min(y, kBelowOne)};
}

double jitter(uint32_t stratum, uint32_t size, uint64_t seed) {
  return std::min((stratum + uniform(child_key(seed, stratum))) / size, kBelowOne);
}

Vec2d scrambled_sobol(uint32_t index, uint64_t seed) {
  const uint64_t seeds = mix64(seed ^ 0x5851f42d4c957f2du);
  const uint32_t shuffled = reverse_bits(scramble_reversed(reverse_bits(index), static_cast<uint32_t>(seed)));
  const uint32_t x = reverse_bits(scramble_reversed(shuffled, static_cast<uint32_t>(seeds)));
  const uint32_t y =
      reverse_bits(scramble_reversed(sobol_second_reversed(shuffled), static_cast<uint32_t>(seeds >> 32)));
  const uint64_t trailing = child_key(seed, index);
  return {to_unit(x, trailing), to_unit(y, trailing >> 32)};
}

double scrambled_van_der_corput(uint32_t index, uint64_t seed) {
  const uint32_t shuffled = reverse_bits(scramble_reversed(reverse_bits(index), static_cast<uint32_t>(seed)));
  const uint32_t x = reverse_bits(scramble_reversed(shuffled, static_cast<uint32_t>(seed >> 32)));
  return to_unit(x, child_key(seed, index));
}

}  // namespace penumbra

#pragma once
// Mixing of 64-bit keys. Cheap enough for one per random number; Philox makes the keys themselves.
#include <cstdint>

namespace penumbra {

/// A bijection of 64 bits in which every output bit depends on every input bit (the finaliser of
/// SplitMix64 with Stafford's constants «Mix13»; Steele, Lea & Flood 2014).
inline uint64_t mix64(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Key of the `index`-th child of `key`: a step of SplitMix64's golden-ratio sequence, mixed.
inline uint64_t child_key(uint64_t key, uint64_t index) {
  return mix64(key + (index + 1) * 0x9e3779b97f4a7c15u);
}

}  // namespace penumbra

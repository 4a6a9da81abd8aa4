#include "worker/textures/noise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace penumbra {
namespace {

/// A well mixed 32-bit hash of a lattice point (the finaliser of MurmurHash3 over each coordinate).
uint32_t lattice_hash(int x, int y, int z) {
  const auto mix = [](uint32_t h) {
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return h ^ (h >> 16);
  };
  return mix(mix(mix(static_cast<uint32_t>(x)) + static_cast<uint32_t>(y)) + static_cast<uint32_t>(z));
}

/// Offset from a lattice point times one of Perlin's twelve gradients, the edges of a cube.
float gradient(int x, int y, int z, const Vec3f& d) {
  const uint32_t h = lattice_hash(x, y, z);
  const int axis = static_cast<int>((h >> 2) % 3);  // the zero component
  const float a = d[(axis + 1) % 3], b = d[(axis + 2) % 3];
  return ((h & 1) != 0 ? -a : a) + ((h & 2) != 0 ? -b : b);
}

float fade(float t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}
float lerp(float t, float a, float b) {
  return a + t * (b - a);
}

float smoothstep(float lo, float hi, float x) {
  const float t = std::clamp((x - lo) / (hi - lo), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

/// Octaves that the footprint leaves, fractional: detail finer than two samples is noise of another kind.
float visible_octaves(const Vec3f& dpdx, const Vec3f& dpdy, int most) {
  const float footprint2 = std::max(dpdx.length2(), dpdy.length2());
  if (!(footprint2 > 0)) return static_cast<float>(most);
  return std::clamp(-1 - 0.5f * std::log2(footprint2), 0.0f, static_cast<float>(most));
}

template <class Term, class Rest>
float sum_octaves(const Vec3f& p, float n, float roughness, const Term& term, const Rest& rest) {
  float sum = 0, frequency = 1, weight = 1;
  const int whole = static_cast<int>(n);
  for (int i = 0; i < whole; ++i) {
    sum += weight * term(noise(p * frequency));
    frequency *= 1.99f;
    weight *= roughness;
  }
  return sum + weight * rest(n - whole, noise(p * frequency));
}

}  // namespace

float noise(const Vec3f& p) {
  const Vec3f cell(std::floor(p.x), std::floor(p.y), std::floor(p.z));
  // Beyond 2³⁰ single precision has no fraction left: the noise is constant there.
  if (!(std::max({std::abs(cell.x), std::abs(cell.y), std::abs(cell.z)}) < 0x1p30f)) return 0;
  const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y), z = static_cast<int>(cell.z);
  const Vec3f d = p - cell;
  const auto corner = [&](int i, int j, int k) {
    return gradient(x + i, y + j, z + k,
                    d - Vec3f(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)));
  };
  const float u = fade(d.x), v = fade(d.y), w = fade(d.z);
  const auto row = [&](int j, int k) { return lerp(u, corner(0, j, k), corner(1, j, k)); };
  return lerp(w, lerp(v, row(0, 0), row(1, 0)), lerp(v, row(0, 1), row(1, 1)));
}

float fbm(const Vec3f& p, const Vec3f& dpdx, const Vec3f& dpdy, const Octaves& octaves) {
  const float n = visible_octaves(dpdx, dpdy, octaves.octaves);
  return sum_octaves(
      p, n, octaves.roughness, [](float v) { return v; },
      [](float part, float v) { return smoothstep(0.3f, 0.7f, part) * v; });
}

// The octaves that are left out are replaced by their mean, 0.2 in pbrt, so that distance does not darken.
float turbulence(const Vec3f& p, const Vec3f& dpdx, const Vec3f& dpdy, const Octaves& octaves) {
  constexpr float kMean = 0.2f;
  const float n = visible_octaves(dpdx, dpdy, octaves.octaves);
  float sum = sum_octaves(
      p, n, octaves.roughness, [](float v) { return std::abs(v); },
      [](float part, float v) { return lerp(smoothstep(0.3f, 0.7f, part), kMean, std::abs(v)); });
  float weight = std::pow(octaves.roughness, std::floor(n));
  for (int i = static_cast<int>(n); i < octaves.octaves; ++i) {
    sum += weight * kMean;
    weight *= octaves.roughness;
  }
  return sum;
}

}  // namespace penumbra

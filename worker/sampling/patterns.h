#pragma once
// Point sets of the unit square as pure functions of (index, size, seed). Every single point is uniform
// over the seeds, whatever the quality of the hashing: patterns change variance, never the mean.
#include <cstdint>

#include "scenes/math.h"

namespace penumbra {

/// Image of i under a pseudo-random permutation of [0,size), i < size. Over the seeds the
/// image of each i is uniform. `seed` (here and below): well mixed bits, as of child_key().
uint32_t permute(uint32_t i, uint32_t size, uint64_t seed);

/// Point `stratum` of `size` multi-jittered points (Chiu, Shirley & Wang 1994), for any size: one point in
/// each of `size` rows, in each of about as many columns, and in each cell of a grid about as fine as a
/// square one. `stratum` numbers the rows: permute it first if the order of the samples matters.
Vec2d multi_jitter(uint32_t stratum, uint32_t size, uint64_t seed);

/// One of `size` jittered points of [0,1), in stratum `stratum`.
double jitter(uint32_t stratum, uint32_t size, uint64_t seed);

/// Point `index` of an Owen-scrambled Sobol' (0,2)-sequence in shuffled order (Burley 2020): any aligned
/// block of 2^k indices is a (0,k,2)-net. Repeats after 2^32 points.
Vec2d scrambled_sobol(uint32_t index, uint64_t seed);

/// The same for its first dimension alone, the van der Corput sequence.
double scrambled_van_der_corput(uint32_t index, uint64_t seed);

}  // namespace penumbra

#pragma once
// One register's worth of floats: Simd (simd.h) where that holds sixteen, and its half on AVX2, whose sixteen
// registers do not hold a block's eighteen coordinates twice over. The same IEEE operations, lane by lane.
//
// Included only by files that are compiled for the instruction set in question.
#include "worker/geometry/simd.h"

namespace penumbra {
namespace {

#if defined(__AVX512F__)

struct Lanes : Simd {
  static constexpr int kLanes = 16;
  using Simd::compress;
  /// Writes the chosen lanes one after another; kLanes floats at p may be overwritten.
  static void compress(float* p, uint32_t chosen, Floats a) {
    _mm512_storeu_ps(p, _mm512_maskz_compress_ps(static_cast<Mask>(chosen), a));
  }
};

#else

struct Lanes {
  static constexpr int kLanes = 8;
  using Floats = __m256;
  using Mask = __m256;  // all ones or all zeros

  static Floats load(const float* p) { return _mm256_load_ps(p); }
  static Floats load_unaligned(const float* p) { return _mm256_loadu_ps(p); }
  static Floats all(float x) { return _mm256_set1_ps(x); }
  static Floats fma(Floats x, Floats y, Floats z) { return _mm256_fmadd_ps(x, y, z); }
  static Floats add(Floats x, Floats y) { return _mm256_add_ps(x, y); }
  static Floats sub(Floats x, Floats y) { return _mm256_sub_ps(x, y); }
  static Floats mul(Floats x, Floats y) { return _mm256_mul_ps(x, y); }
  static Floats div(Floats x, Floats y) { return _mm256_div_ps(x, y); }
  static Floats min(Floats x, Floats y) { return _mm256_min_ps(x, y); }
  static Floats max(Floats x, Floats y) { return _mm256_max_ps(x, y); }
  static Floats abs(Floats x) { return _mm256_andnot_ps(_mm256_set1_ps(-0.f), x); }
  static Mask less(Floats x, Floats y) { return _mm256_cmp_ps(x, y, _CMP_LT_OQ); }
  static Mask less_equal(Floats x, Floats y) { return _mm256_cmp_ps(x, y, _CMP_LE_OQ); }
  static Mask both(Mask x, Mask y) { return _mm256_and_ps(x, y); }
  static Mask either(Mask x, Mask y) { return _mm256_or_ps(x, y); }
  static Mask differ(Mask x, Mask y) { return _mm256_xor_ps(x, y); }
  static Mask without(Mask x, Mask y) { return _mm256_andnot_ps(y, x); }
  /// m ? x : y
  static Floats select(Mask m, Floats x, Floats y) { return _mm256_blendv_ps(y, x, m); }
  static uint32_t bits(Mask m) { return static_cast<uint32_t>(_mm256_movemask_ps(m)); }
  static Mask mask(uint32_t bits) {
    const __m256i lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const __m256i chosen = _mm256_and_si256(_mm256_set1_epi32(static_cast<int>(bits)), lanes);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(chosen, lanes));
  }
  /// Lanes whose number lies in [first, first + count), count > 0.
  static Mask in_range(const uint32_t* p, uint32_t first, uint32_t count) {
    const __m256i offset = _mm256_sub_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(p)),
                                            _mm256_set1_epi32(static_cast<int>(first)));
    // No unsigned comparison in AVX2: offset <= count-1 where the smaller of both is offset.
    const __m256i last = _mm256_set1_epi32(static_cast<int>(count - 1));
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_min_epu32(offset, last), offset));
  }
  /// Writes the chosen lanes one after another; kLanes floats at p may be overwritten.
  static void compress(float* p, uint32_t chosen, Floats x) {
    // Permutation that moves the set bits' lanes to the front: pext packs their byte-wide indices.
    const uint64_t bytes = _pdep_u64(chosen, 0x0101010101010101u) * 0xff;
    const auto packed = static_cast<long long>(_pext_u64(0x0706050403020100u, bytes));
    _mm256_storeu_ps(p, _mm256_permutevar8x32_ps(x, _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(packed))));
  }
  static float lowest(Floats x) {
    __m128 r = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps(x, 1));
    r = _mm_min_ps(r, _mm_movehl_ps(r, r));
    return _mm_cvtss_f32(_mm_min_ss(r, _mm_movehdup_ps(r)));
  }
  static float highest(Floats x) {
    __m128 r = _mm_max_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps(x, 1));
    r = _mm_max_ps(r, _mm_movehl_ps(r, r));
    return _mm_cvtss_f32(_mm_max_ss(r, _mm_movehdup_ps(r)));
  }
};

#endif

}  // namespace
}  // namespace penumbra

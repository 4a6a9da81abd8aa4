#pragma once
// Sixteen floats at a time, the same operations for every instruction set. Only IEEE operations that round
// alike everywhere are used (no reciprocal estimates), so that all paths agree bit for bit.
//
// Included only by files that are compiled for the instruction set in question.
#include <immintrin.h>

#include <bit>
#include <cstdint>

namespace penumbra {
namespace {

#if defined(__AVX512F__)

struct Simd {
  using Floats = __m512;
  using Mask = __mmask16;

  static Floats load(const float* p) { return _mm512_load_ps(p); }
  static Floats load_unaligned(const float* p) { return _mm512_loadu_ps(p); }
  static void store(float* p, Floats a) { _mm512_store_ps(p, a); }
  static Floats all(float a) { return _mm512_set1_ps(a); }
  static Floats fma(Floats a, Floats b, Floats c) { return _mm512_fmadd_ps(a, b, c); }
  static Floats add(Floats a, Floats b) { return _mm512_add_ps(a, b); }
  static Floats sub(Floats a, Floats b) { return _mm512_sub_ps(a, b); }
  static Floats mul(Floats a, Floats b) { return _mm512_mul_ps(a, b); }
  static Floats div(Floats a, Floats b) { return _mm512_div_ps(a, b); }
  static Floats min(Floats a, Floats b) { return _mm512_min_ps(a, b); }
  static Floats max(Floats a, Floats b) { return _mm512_max_ps(a, b); }
  static Floats abs(Floats a) { return _mm512_abs_ps(a); }
  static Mask less(Floats a, Floats b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
  static Mask less_equal(Floats a, Floats b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
  static Mask both(Mask a, Mask b) { return a & b; }
  static Mask either(Mask a, Mask b) { return a | b; }
  static Mask differ(Mask a, Mask b) { return a ^ b; }
  static Mask without(Mask a, Mask b) { return a & static_cast<Mask>(~b); }
  /// m ? a : b
  static Floats select(Mask m, Floats a, Floats b) { return _mm512_mask_blend_ps(m, b, a); }
  static uint32_t bits(Mask m) { return m; }
  static Mask mask(uint32_t bits) { return static_cast<Mask>(bits); }
  /// Lanes whose number lies in [first, first + count).
  static Mask in_range(const uint32_t* p, uint32_t first, uint32_t count) {
    const __m512i offset = _mm512_sub_epi32(_mm512_load_si512(p), _mm512_set1_epi32(static_cast<int>(first)));
    return _mm512_cmplt_epu32_mask(offset, _mm512_set1_epi32(static_cast<int>(count)));
  }
  /// Writes the chosen lanes one after another; 16 floats at p may be overwritten.
  static void compress(float* p, Mask m, Floats a) { _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m, a)); }
  static void compress(uint32_t* p, uint32_t chosen, const uint32_t* from) {
    _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(static_cast<Mask>(chosen), _mm512_load_si512(from)));
  }
  static float lowest(Floats a) { return _mm512_reduce_min_ps(a); }
  static float highest(Floats a) { return _mm512_reduce_max_ps(a); }
};

#else

struct Simd {
  struct Floats {
    __m256 a, b;
  };
  using Mask = Floats;  // all ones or all zeros

  static Floats load(const float* p) { return {_mm256_load_ps(p), _mm256_load_ps(p + 8)}; }
  static Floats load_unaligned(const float* p) { return {_mm256_loadu_ps(p), _mm256_loadu_ps(p + 8)}; }
  static void store(float* p, Floats x) { _mm256_store_ps(p, x.a), _mm256_store_ps(p + 8, x.b); }
  static Floats all(float x) { return {_mm256_set1_ps(x), _mm256_set1_ps(x)}; }
  static Floats fma(Floats x, Floats y, Floats z) {
    return {_mm256_fmadd_ps(x.a, y.a, z.a), _mm256_fmadd_ps(x.b, y.b, z.b)};
  }
  static Floats add(Floats x, Floats y) { return {_mm256_add_ps(x.a, y.a), _mm256_add_ps(x.b, y.b)}; }
  static Floats sub(Floats x, Floats y) { return {_mm256_sub_ps(x.a, y.a), _mm256_sub_ps(x.b, y.b)}; }
  static Floats mul(Floats x, Floats y) { return {_mm256_mul_ps(x.a, y.a), _mm256_mul_ps(x.b, y.b)}; }
  static Floats div(Floats x, Floats y) { return {_mm256_div_ps(x.a, y.a), _mm256_div_ps(x.b, y.b)}; }
  static Floats min(Floats x, Floats y) { return {_mm256_min_ps(x.a, y.a), _mm256_min_ps(x.b, y.b)}; }
  static Floats max(Floats x, Floats y) { return {_mm256_max_ps(x.a, y.a), _mm256_max_ps(x.b, y.b)}; }
  static Floats abs(Floats x) {
    const __m256 sign = _mm256_set1_ps(-0.f);
    return {_mm256_andnot_ps(sign, x.a), _mm256_andnot_ps(sign, x.b)};
  }
  static Mask less(Floats x, Floats y) {
    return {_mm256_cmp_ps(x.a, y.a, _CMP_LT_OQ), _mm256_cmp_ps(x.b, y.b, _CMP_LT_OQ)};
  }
  static Mask less_equal(Floats x, Floats y) {
    return {_mm256_cmp_ps(x.a, y.a, _CMP_LE_OQ), _mm256_cmp_ps(x.b, y.b, _CMP_LE_OQ)};
  }
  static Mask both(Mask x, Mask y) { return {_mm256_and_ps(x.a, y.a), _mm256_and_ps(x.b, y.b)}; }
  static Mask either(Mask x, Mask y) { return {_mm256_or_ps(x.a, y.a), _mm256_or_ps(x.b, y.b)}; }
  static Mask differ(Mask x, Mask y) { return {_mm256_xor_ps(x.a, y.a), _mm256_xor_ps(x.b, y.b)}; }
  static Mask without(Mask x, Mask y) { return {_mm256_andnot_ps(y.a, x.a), _mm256_andnot_ps(y.b, x.b)}; }
  /// m ? x : y
  static Floats select(Mask m, Floats x, Floats y) {
    return {_mm256_blendv_ps(y.a, x.a, m.a), _mm256_blendv_ps(y.b, x.b, m.b)};
  }
  static uint32_t bits(Mask m) {
    return static_cast<uint32_t>(_mm256_movemask_ps(m.a)) | static_cast<uint32_t>(_mm256_movemask_ps(m.b))
                                                                << 8;
  }
  static Mask mask(uint32_t bits) {
    const __m256i lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    const __m256i low = _mm256_set1_epi32(static_cast<int>(bits)),
                  high = _mm256_set1_epi32(static_cast<int>(bits >> 8));
    return {_mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(low, lanes), lanes)),
            _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(high, lanes), lanes))};
  }
  /// Lanes whose number lies in [first, first + count).
  static Mask in_range(const uint32_t* p, uint32_t first, uint32_t count) {
    return {in_range8(p, first, count), in_range8(p + 8, first, count)};
  }
  /// Writes the chosen lanes one after another; 16 floats at p may be overwritten.
  static void compress(float* p, Mask m, Floats x) {
    const auto low = static_cast<uint32_t>(_mm256_movemask_ps(m.a)),
               high = static_cast<uint32_t>(_mm256_movemask_ps(m.b));
    _mm256_storeu_ps(p, _mm256_permutevar8x32_ps(x.a, chosen_first(low)));
    _mm256_storeu_ps(p + std::popcount(low), _mm256_permutevar8x32_ps(x.b, chosen_first(high)));
  }
  static void compress(uint32_t* p, uint32_t chosen, const uint32_t* from) {
    for (; chosen != 0; chosen &= chosen - 1) *p++ = from[std::countr_zero(chosen)];
  }
  static float lowest(Floats x) {
    const __m256 m = _mm256_min_ps(x.a, x.b);
    __m128 r = _mm_min_ps(_mm256_castps256_ps128(m), _mm256_extractf128_ps(m, 1));
    r = _mm_min_ps(r, _mm_movehl_ps(r, r));
    return _mm_cvtss_f32(_mm_min_ss(r, _mm_movehdup_ps(r)));
  }
  static float highest(Floats x) {
    const __m256 m = _mm256_max_ps(x.a, x.b);
    __m128 r = _mm_max_ps(_mm256_castps256_ps128(m), _mm256_extractf128_ps(m, 1));
    r = _mm_max_ps(r, _mm_movehl_ps(r, r));
    return _mm_cvtss_f32(_mm_max_ss(r, _mm_movehdup_ps(r)));
  }

 private:
  static __m256 in_range8(const uint32_t* p, uint32_t first, uint32_t count) {
    if (count == 0) return _mm256_setzero_ps();
    const __m256i offset = _mm256_sub_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(p)),
                                            _mm256_set1_epi32(static_cast<int>(first)));
    // No unsigned comparison in AVX2: offset <= count-1 where the smaller of both is offset.
    const __m256i last = _mm256_set1_epi32(static_cast<int>(count - 1));
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_min_epu32(offset, last), offset));
  }
  /// Permutation that moves the set bits' lanes to the front: pext packs their byte-wide indices.
  static __m256i chosen_first(uint32_t bits) {
    const uint64_t bytes = _pdep_u64(bits, 0x0101010101010101u) * 0xff;
    return _mm256_cvtepu8_epi32(
        _mm_cvtsi64_si128(static_cast<long long>(_pext_u64(0x0706050403020100u, bytes))));
  }
};

#endif

}  // namespace
}  // namespace penumbra

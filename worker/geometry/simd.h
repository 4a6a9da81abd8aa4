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
  static constexpr int kLanes = 16;
  using Floats = __m512;
  using Mask = __mmask16;

  static Floats load(const float* p) { return _mm512_load_ps(p); }
  static Floats load_unaligned(const float* p) { return _mm512_loadu_ps(p); }
  static void store(float* p, Floats a) { _mm512_store_ps(p, a); }
  static Floats all(float a) { return _mm512_set1_ps(a); }
  static Floats fma(Floats a, Floats b, Floats c) { return _mm512_fmadd_ps(a, b, c); }
  /// c - a b
  static Floats minus_fma(Floats a, Floats b, Floats c) { return _mm512_fnmadd_ps(a, b, c); }
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
  /// The first n lanes; all of them if n is more.
  static Mask first(int n) { return static_cast<Mask>(n < kLanes ? (1u << n) - 1 : 0xffff); }
  /// Lanes whose number lies in [first, first + count).
  static Mask in_range(const uint32_t* p, uint32_t first, uint32_t count) {
    const __m512i offset = _mm512_sub_epi32(_mm512_load_si512(p), _mm512_set1_epi32(static_cast<int>(first)));
    return _mm512_cmplt_epu32_mask(offset, _mm512_set1_epi32(static_cast<int>(count)));
  }
  /// Writes the chosen lanes one after another; 16 floats at p may be overwritten.
  static void compress(float* p, Mask m, Floats a) { _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m, a)); }
  static void compress(float* p, Floats a, float* q, Floats b, uint32_t chosen) {
    compress(p, static_cast<Mask>(chosen), a), compress(q, static_cast<Mask>(chosen), b);
  }
  static void compress(uint32_t* p, uint32_t chosen, const uint32_t* from) {
    _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(static_cast<Mask>(chosen), _mm512_load_si512(from)));
  }
  static float lowest(Floats a) { return _mm512_reduce_min_ps(a); }
  static float highest(Floats a) { return _mm512_reduce_max_ps(a); }
};
using Register = Simd;

#else

/// Eight lanes: one register. Loops that need many registers go over a block in two of these.
struct Register {
  static constexpr int kLanes = 8;
  using Floats = __m256;
  using Mask = __m256;  // all ones or all zeros

  static Floats load(const float* p) { return _mm256_load_ps(p); }
  static Floats load_unaligned(const float* p) { return _mm256_loadu_ps(p); }
  static void store(float* p, Floats x) { _mm256_store_ps(p, x); }
  static Floats all(float x) { return _mm256_set1_ps(x); }
  static Floats fma(Floats x, Floats y, Floats z) { return _mm256_fmadd_ps(x, y, z); }
  /// z - x y
  static Floats minus_fma(Floats x, Floats y, Floats z) { return _mm256_fnmadd_ps(x, y, z); }
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
    const __m256i all = _mm256_set1_epi32(static_cast<int>(bits));
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(all, lanes), lanes));
  }
  /// The first n lanes; all of them if n is more.
  static Mask first(int n) {
    return _mm256_castsi256_ps(
        _mm256_cmpgt_epi32(_mm256_set1_epi32(n), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)));
  }
  /// Lanes whose number lies in [first, first + count).
  static Mask in_range(const uint32_t* p, uint32_t first, uint32_t count) {
    if (count == 0) return _mm256_setzero_ps();
    const __m256i offset = _mm256_sub_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(p)),
                                            _mm256_set1_epi32(static_cast<int>(first)));
    // No unsigned comparison in AVX2: offset <= count-1 where the smaller of both is offset.
    const __m256i last = _mm256_set1_epi32(static_cast<int>(count - 1));
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_min_epu32(offset, last), offset));
  }
  /// Writes the chosen lanes of both one after another; a whole register at p and q may be overwritten.
  static void compress(float* p, Floats x, float* q, Floats y, uint32_t chosen) {
    const __m256i first = chosen_first(chosen);
    _mm256_storeu_ps(p, _mm256_permutevar8x32_ps(x, first));
    _mm256_storeu_ps(q, _mm256_permutevar8x32_ps(y, first));
  }
  static void compress(uint32_t* p, uint32_t chosen, const uint32_t* from) {
    const __m256i lanes = _mm256_load_si256(reinterpret_cast<const __m256i*>(from));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(p),
                        _mm256_permutevar8x32_epi32(lanes, chosen_first(chosen)));
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
  /// Permutation that moves the set bits' lanes to the front: pext packs their byte-wide indices.
  static __m256i chosen_first(uint32_t bits) {
    const uint64_t bytes = _pdep_u64(bits, 0x0101010101010101u) * 0xff;
    return _mm256_cvtepu8_epi32(
        _mm_cvtsi64_si128(static_cast<long long>(_pext_u64(0x0706050403020100u, bytes))));
  }
};

/// Sixteen lanes: two registers.
struct Simd {
  using R = Register;
  struct Floats {
    __m256 a, b;
  };
  using Mask = Floats;  // all ones or all zeros

  static Floats load(const float* p) { return {R::load(p), R::load(p + 8)}; }
  static Floats load_unaligned(const float* p) { return {R::load_unaligned(p), R::load_unaligned(p + 8)}; }
  static void store(float* p, Floats x) { R::store(p, x.a), R::store(p + 8, x.b); }
  static Floats all(float x) { return {R::all(x), R::all(x)}; }
  static Floats fma(Floats x, Floats y, Floats z) { return {R::fma(x.a, y.a, z.a), R::fma(x.b, y.b, z.b)}; }
  static Floats add(Floats x, Floats y) { return {R::add(x.a, y.a), R::add(x.b, y.b)}; }
  static Floats sub(Floats x, Floats y) { return {R::sub(x.a, y.a), R::sub(x.b, y.b)}; }
  static Floats mul(Floats x, Floats y) { return {R::mul(x.a, y.a), R::mul(x.b, y.b)}; }
  static Floats min(Floats x, Floats y) { return {R::min(x.a, y.a), R::min(x.b, y.b)}; }
  static Floats max(Floats x, Floats y) { return {R::max(x.a, y.a), R::max(x.b, y.b)}; }
  static Mask less(Floats x, Floats y) { return {R::less(x.a, y.a), R::less(x.b, y.b)}; }
  static Mask less_equal(Floats x, Floats y) { return {R::less_equal(x.a, y.a), R::less_equal(x.b, y.b)}; }
  static Mask both(Mask x, Mask y) { return {R::both(x.a, y.a), R::both(x.b, y.b)}; }
  static Mask either(Mask x, Mask y) { return {R::either(x.a, y.a), R::either(x.b, y.b)}; }
  static Mask without(Mask x, Mask y) { return {R::without(x.a, y.a), R::without(x.b, y.b)}; }
  /// m ? x : y
  static Floats select(Mask m, Floats x, Floats y) {
    return {R::select(m.a, x.a, y.a), R::select(m.b, x.b, y.b)};
  }
  static uint32_t bits(Mask m) { return R::bits(m.a) | R::bits(m.b) << 8; }
  static Mask mask(uint32_t bits) { return {R::mask(bits), R::mask(bits >> 8)}; }
  /// Lanes whose number lies in [first, first + count).
  static Mask in_range(const uint32_t* p, uint32_t first, uint32_t count) {
    return {R::in_range(p, first, count), R::in_range(p + 8, first, count)};
  }
  /// Writes the chosen lanes one after another; 16 numbers at p may be overwritten.
  static void compress(float* p, Mask m, Floats x) {
    const uint32_t low = R::bits(m.a), high = R::bits(m.b);
    _mm256_storeu_ps(p, _mm256_permutevar8x32_ps(x.a, R::chosen_first(low)));
    _mm256_storeu_ps(p + std::popcount(low), _mm256_permutevar8x32_ps(x.b, R::chosen_first(high)));
  }
  static void compress(uint32_t* p, uint32_t chosen, const uint32_t* from) {
    R::compress(p, chosen & 0xff, from);
    R::compress(p + std::popcount(chosen & 0xff), chosen >> 8, from + 8);
  }
  static float lowest(Floats x) { return R::lowest(R::min(x.a, x.b)); }
  static float highest(Floats x) { return R::highest(R::max(x.a, x.b)); }
};

#endif

}  // namespace
}  // namespace penumbra

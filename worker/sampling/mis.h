#pragma once
// Weights of multiple importance sampling (Veach 1997, §9.2) for N strategies, for one point: n_i samples of
// strategy i, whose density there is p_i. n_i is an expected number, not always whole: a light that is drawn
// from many is asked less than once. Densities may be of any measure, as long as it is the same one; of
// any size that a double holds; 0 or infinite. No result is ever NaN, no sum overflows.
#include <span>

namespace penumbra {

/// w_i = n_i p_i s_i / Σ_j n_j p_j s_j, the balance heuristic with each density scaled by smoothing s_i in
/// [0,1] (SJ19, discontinuity-smoothing MIS); `smoothing` may be empty: all 1. A density of 0 has weight 0.
/// Infinite densities share the weight in proportion to n_i s_i, or n_i if all those s_i are 0. If nothing
/// can have produced the point, all weights are 0. The spans are of one length; counts are not negative.
void balance_weights(std::span<const double> counts, std::span<const double> pdfs,
                     std::span<const double> smoothing, std::span<double> out);

/// w_i = (n_i p_i)² / Σ_j (n_j p_j)²; conventions as above.
void power_weights(std::span<const double> counts, std::span<const double> pdfs, std::span<double> out);

/// 1 / Σ_j n_j p_j: what the balance heuristic's f/p needs, all samples alike. 0 if a density is infinite,
/// infinite if all are 0.
double inverse_sum(std::span<const double> counts, std::span<const double> pdfs);

}  // namespace penumbra

#pragma once
// The measure of `line-sa` along a chord: with d the distance of x to the chord's line and y the signed
// offset from the foot of x on it, h(y) = y/√(d²+y²), the sine of the angle at x (UFK13, §4). A point with h
// uniform is uniform in solid angle among the chords of a rectangle.
namespace penumbra {

/// h(y0 + length) − h(y0); unitless, in [0,2]. Accurate relative to itself for any position of the foot.
double height_difference(double y0, double length, double d2);

/// Offset t in [0,length] such that h is fraction v of its way from y0 to y0 + length.
double sample_height(double y0, double length, double d2, double v);

// The measure of a triangle's `line-sa` along a chord from its apex: 1 − cosθ, θ the angle at x from the apex
// (Arvo 1995). t0: signed offset of the apex from the foot of x on the chord's line, d > 0 the distance of x
// to it; points of the chord are given by their distance from the apex.

/// cosθ(near) − cosθ(far), near <= far; unitless, in [0,2]. Accurate relative to itself.
double versine_difference(double t0, double d, double near, double far);

/// The point of [near,far] at fraction v of that difference.
double sample_versine(double t0, double d, double near, double far, double v);

}  // namespace penumbra

#pragma once
// The vector types of the whole project: Imath's. Row vectors: p' = p * M, so the first transform that
// acts on a point is the leftmost factor, and pbrt's sixteen numbers (column-major, column vectors) are
// an Imath matrix as they stand.
#include <ImathColor.h>
#include <ImathMatrix.h>
#include <ImathVec.h>

namespace penumbra {

using Vec2f = Imath::V2f;
using Vec2d = Imath::V2d;
using Vec3f = Imath::V3f;
using Vec3d = Imath::V3d;
using Matrix = Imath::M44d;
using Rgb = Imath::C3f;  ///< linear, Rec. 709 primaries

}  // namespace penumbra

#pragma once
// pbrt's transform directives as row-vector matrices: the transform that a directive appends to the
// current one is T * CTM (it acts on points first).
#include <optional>
#include <span>

#include "scenes/math.h"

namespace penumbra {

Matrix translation(const Vec3d& by);
Matrix scaling(const Vec3d& by);

/// Right-handed, about an axis of any length; empty for the zero axis.
std::optional<Matrix> rotation(double degrees, const Vec3d& axis);

/// World to camera: the camera at `eye` looks along +z at `target`, +y towards `up` (left-handed, as
/// pbrt's). Empty where eye and target coincide or `up` is parallel to the view.
std::optional<Matrix> look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up);

/// pbrt's sixteen numbers: column-major for column vectors, hence row by row for ours.
Matrix matrix_of(std::span<const double> sixteen);

bool is_finite(const Matrix& m);

/// True if the linear part has no inverse to the accuracy of its own entries.
bool is_singular(const Matrix& m);

/// The same map of points with (0,0,0,1) as its last column; empty if it is not affine.
std::optional<Matrix> as_affine(const Matrix& m);

/// Without translation and projection: how directions are mapped.
Matrix linear_part(const Matrix& m);

}  // namespace penumbra

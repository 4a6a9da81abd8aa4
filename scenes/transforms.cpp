#include "scenes/transforms.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "proto/status.h"

namespace penumbra {

Matrix translation(const Vec3d& by) {
  Matrix m;
  m.setTranslation(by);
  return m;
}

Matrix scaling(const Vec3d& by) {
  Matrix m;
  m.setScale(by);
  return m;
}

std::optional<Matrix> rotation(double degrees, const Vec3d& axis) {
  const double length = axis.length();
  if (!(length > 0)) return std::nullopt;
  Matrix m;
  m.setAxisAngle(axis / length, degrees * (std::numbers::pi / 180));
  return m;
}

std::optional<Matrix> look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up) {
  // A direction known to fewer digits than its float inputs carry is noise.
  constexpr double kParallel = std::numeric_limits<float>::epsilon();
  const Vec3d view = target - eye;
  if (!(view.length() > 0) || !(up.length() > 0)) return std::nullopt;
  const Vec3d forward = view.normalized();
  const Vec3d across = up.normalized().cross(forward);
  if (!(across.length() > kParallel)) return std::nullopt;
  const Vec3d right = across.normalized();
  const Vec3d above = forward.cross(right);
  // The inverse of the rigid map with rows right, above, forward, eye.
  return Matrix(right.x, above.x, forward.x, 0,  //
                right.y, above.y, forward.y, 0,  //
                right.z, above.z, forward.z, 0,  //
                -right.dot(eye), -above.dot(eye), -forward.dot(eye), 1);
}

Matrix matrix_of(std::span<const double> sixteen) {
  PENUMBRA_CHECK(sixteen.size() == 16);
  Matrix m;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) m[row][column] = sixteen[4 * row + column];
  return m;
}

bool is_finite(const Matrix& m) {
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      if (!std::isfinite(m[row][column])) return false;
  return true;
}

bool is_singular(const Matrix& m) {
  Vec3d row[3];
  for (int i = 0; i < 3; ++i) {
    row[i] = Vec3d(m[i][0], m[i][1], m[i][2]);
    const double length = row[i].length();
    if (!(length > 0) || !std::isfinite(length)) return true;
    row[i] /= length;
  }
  // The rows' lengths say nothing about singularity (a scale of 1e-8 along z is fine); with unit rows the
  // determinant is the volume of their parallelepiped, 1 where they are orthogonal. It is computed to
  // about 10 roundings of terms <= 1, and entries are products of a few transforms, each rounding once.
  constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
  return !(std::abs(row[0].dot(row[1].cross(row[2]))) > kRounding);
}

std::optional<Matrix> as_affine(const Matrix& m) {
  const double w = m[3][3];
  if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || w == 0) return std::nullopt;
  if (w == 1) return m;
  Matrix affine = m;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 3; ++column) affine[row][column] /= w;
  affine[3][3] = 1;
  return affine;
}

Matrix linear_part(const Matrix& m) {
  Matrix linear;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) linear[row][column] = m[row][column];
  return linear;
}

}  // namespace penumbra

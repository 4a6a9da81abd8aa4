#include "scenes/transforms.h"

#include <ImathMatrixAlgo.h>

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
  Imath::M33d linear(m[0][0], m[0][1], m[0][2], m[1][0], m[1][1], m[1][2], m[2][0], m[2][1], m[2][2]);
  // A scale along an axis, before or after a rotation, is no defect however strong it is: rows and columns
  // are first brought to length 1. What is left is judged by its condition.
  for (const bool by_rows : {true, false}) {
    if (!by_rows) linear.transpose();
    for (int i = 0; i < 3; ++i) {
      const double length = Vec3d(linear[i][0], linear[i][1], linear[i][2]).length();
      if (!(length > 0) || !std::isfinite(length)) return true;
      for (int k = 0; k < 3; ++k) linear[i][k] /= length;
    }
  }
  // The usual case needs no decomposition: with unit columns |det| = σ1 σ2 σ3 <= 3 σ3.
  if (std::abs(linear.determinant()) > 1e-3) return false;
  Imath::M33d left, right;
  Vec3d singular_values;
  Imath::jacobiSVD(linear, left, singular_values, right);
  // Entries are sums of products of a few transforms, each rounding in double.
  constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
  return !(std::abs(singular_values[2]) > kRounding * singular_values[0]);
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

#include "scenes/animated_transform.h"

#include <ImathMatrixAlgo.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace penumbra {
namespace {

Imath::M33d linear_of(const Matrix& m) {
  return {m[0][0], m[0][1], m[0][2], m[1][0], m[1][1], m[1][2], m[2][0], m[2][1], m[2][2]};
}

Matrix affine(const Imath::M33d& linear, const Vec3d& translation) {
  Matrix m;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) m[i][k] = linear[i][k];
    m[3][i] = translation[i];
  }
  return m;
}

/// Sum of the squares of all entries.
double norm2(const Imath::M33d& m) {
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) sum += m[i][k] * m[i][k];
  return sum;
}

/// Orthogonal factor of the polar decomposition, by Newton's iteration with scaling (Higham 1986): quadratic
/// once it is near, and near in a few steps.
Imath::M33d orthogonal_factor(const Imath::M33d& linear) {
  Imath::M33d r = linear;
  // Each step squares what is wrong; a hundred are those of pbrt, which does not scale.
  for (int step = 0; step < 100; ++step) {
    const Imath::M33d inverse = r.gjInverse().transposed();
    const double scale = std::pow(norm2(inverse) / norm2(r), 0.25);
    const Imath::M33d next = (r * scale + inverse * (1 / scale)) * 0.5;
    const double change = norm2(next - r);
    r = next;
    // The next change would be the square of this one.
    if (change <= std::numeric_limits<double>::epsilon() * 0x1p-10) break;
  }
  return r;
}

struct Parts {
  Imath::M33d stretch;
  Imath::Quatd rotation;
  bool mirrors;
};

Parts decompose(const Matrix& m) {
  const Imath::M33d linear = linear_of(m);
  const bool mirrors = linear.determinant() < 0;
  // A mirror belongs to the stretch: what is left turns.
  const Imath::M33d rotation = orthogonal_factor(linear) * (mirrors ? -1.0 : 1.0);
  return {linear * rotation.transposed(), Imath::extractQuat(affine(rotation, Vec3d(0))).normalized(),
          mirrors};
}

Imath::M33d mix(const Imath::M33d& a, const Imath::M33d& b, double t) {
  return a * (1 - t) + b * t;
}

Vec3d corner_of(const MovedBox& box, int corner) {
  return {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
          corner & 4 ? box.hi.z : box.lo.z};
}

}  // namespace

Shutter shutter_of(const SceneDescription& description) {
  const double from = description.transform_start_time;
  const double length = description.transform_end_time - from;
  const Params& camera = description.camera.params;
  return {(camera.number("shutteropen", 0) - from) / length,
          (camera.number("shutterclose", 1) - from) / length};
}

std::optional<AnimatedTransform> AnimatedTransform::between(const Matrix& start, const Matrix& end,
                                                            const Shutter& shutter) {
  static std::atomic<uint64_t> made{0};
  const Parts first = decompose(start), second = decompose(end);
  if (first.mirrors != second.mirrors) return std::nullopt;
  AnimatedTransform animated;
  animated.id_ = ++made;
  animated.shutter_ = shutter;
  animated.start_ = start;
  animated.end_ = end;
  animated.stretch_[0] = first.stretch;
  animated.stretch_[1] = second.stretch;
  animated.rotation_[0] = first.rotation;
  // Of the two quaternions of a rotation the nearer one: the shorter way round.
  animated.rotation_[1] = (first.rotation ^ second.rotation) < 0 ? -second.rotation : second.rotation;
  animated.translation_[0] = {start[3][0], start[3][1], start[3][2]};
  animated.translation_[1] = {end[3][0], end[3][1], end[3][2]};
  animated.same_linear_ = linear_of(start) == linear_of(end);
  // Points turn by twice the angle of their quaternions.
  animated.angle_ =
      animated.same_linear_ ? 0 : 2 * Imath::angle4D(animated.rotation_[0], animated.rotation_[1]);
  return animated;
}

double AnimatedTransform::clamped(double u) const {
  return std::clamp(shutter_.open + u * (shutter_.close - shutter_.open), 0.0, 1.0);
}

Matrix AnimatedTransform::at(double u) const {
  const double t = clamped(u);
  if (t == 0) return start_;
  if (t == 1) return end_;
  const Vec3d translation = translation_[0] * (1 - t) + translation_[1] * t;
  if (same_linear_) return affine(linear_of(start_), translation);
  // Imath's slerp is exact also for small angles, where pbrt's is linear: they differ by less than 1e-5 of
  // the way.
  const Imath::M33d rotation = Imath::slerp(rotation_[0], rotation_[1], t).toMatrix33();
  return affine(mix(stretch_[0], stretch_[1], t) * rotation, translation);
}

double AnimatedTransform::turn() const {
  if (same_linear_) return 0;
  const double smaller = std::min(norm2(stretch_[0]), norm2(stretch_[1]));
  const double growth = std::sqrt(norm2(stretch_[1] - stretch_[0]) / smaller);
  return std::abs(clamped(1) - clamped(0)) * (angle_ + growth);
}

void AnimatedTransform::add_ends(std::vector<double>& times) const {
  for (const double end : {0.0, 1.0}) {
    const double u = (end - shutter_.open) / (shutter_.close - shutter_.open);
    if (u > 0 && u < 1) times.push_back(u);
  }
}

/// A point c is at q(t) R(t) + T(t), with q = c stretch(t) and T linear in t and R turning evenly by `angle`:
/// its acceleration is q R″ + 2 q′ R′, no longer than angle² |q| + 2 angle |q′|. Over a step h it leaves the
/// straight way by at most h²/8 of that. Where the motion begins or ends within a step, by its whole way
/// there.
double AnimatedTransform::deviation(const MovedBox& object, int n) const {
  double size = 0, growth = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d c = corner_of(object, corner), q0 = c * stretch_[0], q1 = c * stretch_[1];
    size = std::max({size, q0.length(), q1.length()});
    growth = std::max(growth, (q1 - q0).length());
  }
  const double h = std::abs(shutter_.close - shutter_.open) / n;
  double most = h * h / 8 * (angle_ * angle_ * size + 2 * angle_ * growth);
  const double lo = std::min(shutter_.open, shutter_.close), hi = std::max(shutter_.open, shutter_.close);
  if (lo < 0 || hi > 1) most += h * (angle_ * size + growth + (translation_[1] - translation_[0]).length());
  return most;
}

std::vector<MovedBox> AnimatedTransform::boxes(const MovedBox& object) const {
  // Steps so that the boxes grow by no more than a sixteenth of the object; more than 64 serve nobody.
  const double enough = (object.hi - object.lo).length() / 16;
  int n = 1;
  while (n < 64 && deviation(object, n) > enough) n *= 2;
  const double wider = deviation(object, n);
  std::vector<MovedBox> boxes;
  for (int step = 0; step <= n; ++step) {
    const Matrix m = at(double(step) / n);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    MovedBox box{Vec3d(kInfinity), Vec3d(-kInfinity)};
    for (int corner = 0; corner < 8; ++corner) {
      Vec3d p;
      m.multVecMatrix(corner_of(object, corner), p);
      for (int k = 0; k < 3; ++k) {
        box.lo[k] = std::min(box.lo[k], p[k] - wider);
        box.hi[k] = std::max(box.hi[k], p[k] + wider);
      }
    }
    boxes.push_back(box);
  }
  return boxes;
}

}  // namespace penumbra

#include "worker/effects/portal.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "proto/status.h"

namespace penumbra {
namespace {

/// pbrt's measure of a rectangle: edges' cosines may be off by this.
constexpr double kSlack = 1e-3;

Vec3d in_axes(const Imath::M33d& axes, const Vec3d& v) {
  return v * axes.transposed();
}

}  // namespace

absl::StatusOr<std::shared_ptr<Portal>> Portal::build(const Param& param, const SceneDescription& description) {
  const std::string at = description.place(param.loc);
  if (param.numbers.size() != 12)
    return invalid_input("{}: a portal needs four points, here are {} numbers", at, param.numbers.size());
  std::array<Vec3d, 4> p;
  for (size_t i = 0; i < 4; ++i)
    p[i] = {param.numbers[3 * i], param.numbers[3 * i + 1], param.numbers[3 * i + 2]};
  const Vec3d p01 = (p[1] - p[0]).normalized(), p12 = (p[2] - p[1]).normalized(),
              p32 = (p[2] - p[3]).normalized(), p03 = (p[3] - p[0]).normalized();
  // Written so that what is not a number fails.
  const bool parallel = std::abs(p01.dot(p32) - 1) <= kSlack && std::abs(p12.dot(p03) - 1) <= kSlack;
  const bool square = std::abs(p01.dot(p12)) <= kSlack && std::abs(p12.dot(p32)) <= kSlack &&
                      std::abs(p32.dot(p03)) <= kSlack && std::abs(p03.dot(p01)) <= kSlack;
  if (!parallel || !square)
    return invalid_input("{}: the portal's four points are not the corners of a rectangle, in order", at);
  auto made = std::make_shared<Portal>();
  Portal& portal = *made;
  const Vec3d u = p[1] - p[0], v = p[3] - p[0] - p01 * (p[3] - p[0]).dot(p01);
  portal.corner_ = p[0];
  portal.size_ = {u.length(), v.length(), 0};
  // u × v points to where light goes.
  const Vec3d across = v.normalized(), to_sky = across.cross(p01);
  for (int k = 0; k < 3; ++k) {
    portal.axes_[0][k] = p01[k];
    portal.axes_[1][k] = across[k];
    portal.axes_[2][k] = to_sky[k];
  }
  portal.shape_ = QuadShape{Vec3f(p[0]), Vec3f(u), Vec3f(v)};
  return made;
}

bool Portal::passes(const Vec3d& x, const Vec3d& w) const {
  const Vec3d from = in_axes(axes_, corner_ - x), d = in_axes(axes_, w);
  if (!(from.z > 0 && d.z > 0)) return false;
  const double a = d.x * from.z - from.x * d.z, b = d.y * from.z - from.y * d.z;
  return a >= 0 && b >= 0 && a <= size_.x * d.z && b <= size_.y * d.z;
}

SeenPortal::SeenPortal(const Portal& portal, const Vec3d& x) : portal_(&portal), seen_(portal.shape(), x) {
  const auto& quad = std::get<QuadShape>(portal.shape());
  lo_ = in_axes(portal.axes(), Vec3d(quad.o) - x);
  hi_ = lo_ + Vec3d(Vec3d(quad.u).length(), Vec3d(quad.v).length(), 0);
  if (!(lo_.z > 0) || portal.table() == nullptr || !(seen_.solid_angle() > 0)) return;
  window_.lo = window_place(lo_);
  window_.hi = window_place(hi_);
  integral_ = portal.table()->integral(window_);
}

SeenPortal::Sample SeenPortal::sample(const Vec2d& u) const {
  if (!(seen_.solid_angle() > 0)) return {};
  if (portal_->table() == nullptr) {
    const LightPoint at = seen_.sample(u);
    return {(at.p - seen_.x()).normalized(), at.pdf};
  }
  if (!(integral_ > 0)) return {};
  const Vec2d place = portal_->table()->sample(window_, integral_, u);
  // The tangent loses digits where the angle is near a right one: the rectangle's border says where it ends.
  Vec3d d = window_direction(place) * lo_.z;
  d.x = std::clamp(d.x, lo_.x, hi_.x);
  d.y = std::clamp(d.y, lo_.y, hi_.y);
  d.z = lo_.z;
  const double pdf = portal_->table()->pdf(integral_, place) / window_solid_angle(d);
  return {(d * portal_->axes()).normalized(), pdf};
}

double SeenPortal::pdf(const Vec3d& w) const {
  if (!(seen_.solid_angle() > 0) || !portal_->passes(seen_.x(), w)) return 0;
  if (portal_->table() == nullptr) return 1 / seen_.solid_angle();
  if (!(integral_ > 0)) return 0;
  const Vec3d d = in_axes(portal_->axes(), w);
  return portal_->table()->pdf(integral_, window_place(d)) / window_solid_angle(d);
}

LightLine SeenPortal::moved(LightLine line, double far) const {
  if (!(line.scale > 0)) return line;
  const double times = far / lo_.z;
  line.corner = seen_.x() + (line.corner - seen_.x()) * times;
  line.from *= times;
  line.along *= times;
  line.a = line.corner + line.from;
  line.b = line.a + line.along;
  return line;
}

LightLine SeenPortal::choose_chord(bool along_u, double u, double far) const {
  if (!(lo_.z > 0)) return {};
  return moved(choose_line_solid_angle(seen_, along_u, u), far);
}

LightLine SeenPortal::chord_through(bool along_u, const Vec3d& p, double far) const {
  if (!(lo_.z > 0)) return {};
  return moved(line_solid_angle_through(seen_, along_u, seen_.x() + (p - seen_.x()) * (lo_.z / far)), far);
}

double SeenPortal::distance_to(const Vec3d& w, double far) const {
  const double cosine = in_axes(portal_->axes(), w).z;
  return cosine > 0 ? far / cosine : far;
}

}  // namespace penumbra

#include "worker/materials/trowbridge_reitz.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/materials/local_frame.h"
#include "worker/sampling/warp.h"

namespace penumbra {

// D = 1 / (π αx αy cos⁴θ (1 + tan²θ (cos²φ/αx² + sin²φ/αy²))²); with cos⁴θ drawn into the bracket nothing
// is divided by a small cosine.
double distribution(const TrowbridgeReitz& d, const Vec3d& wh) {
  const double x = wh.x / d.alpha_x, y = wh.y / d.alpha_y;
  const double stretched = x * x + y * y + wh.z * wh.z;
  return 1 / (std::numbers::pi * d.alpha_x * d.alpha_y * stretched * stretched);
}

// (√(1+a) - 1)/2 with a = α² tan²θ, rationalised: exact for small a too.
double lambda(const TrowbridgeReitz& d, const Vec3d& w) {
  const double x = d.alpha_x * w.x, y = d.alpha_y * w.y;
  const double a = (x * x + y * y) / (w.z * w.z);
  return a / (2 * (1 + std::sqrt(1 + a)));
}

double masking(const TrowbridgeReitz& d, const Vec3d& w) {
  return 1 / (1 + lambda(d, w));
}

double masking_shadowing(const TrowbridgeReitz& d, const Vec3d& wo, const Vec3d& wi) {
  return 1 / (1 + lambda(d, wo) + lambda(d, wi));
}

// Heitz 2018, "Sampling the GGX distribution of visible normals": in the space where the ellipsoid is a
// sphere, its part seen from the stretched direction projects to a disk whose lower half is squeezed.
Vec3d sample_visible_normal(const TrowbridgeReitz& d, const Vec3d& wo, const Vec2d& u) {
  const double side = wo.z < 0 ? -1 : 1;
  const Vec3d v = Vec3d(d.alpha_x * wo.x, d.alpha_y * wo.y, wo.z).normalized() * side;
  Vec3d t1, t2;
  frame(v, t1, t2);
  // The squeeze is along the projection of the pole, so the second axis must lie in its plane with v.
  if (const double length = std::hypot(v.x, v.y); length > 0) {
    t1 = Vec3d(-v.y, v.x, 0) / length;
    t2 = v % t1;
  }
  const Vec2d disk = square_to_disk_concentric(u);
  const double s = (1 + v.z) / 2;
  const double p1 = disk.x;
  const double p2 = (1 - s) * std::sqrt(std::max(0.0, 1 - p1 * p1)) + s * disk.y;
  const double p3 = std::sqrt(std::max(0.0, 1 - p1 * p1 - p2 * p2));
  const Vec3d n = t1 * p1 + t2 * p2 + v * p3;
  return Vec3d(d.alpha_x * n.x, d.alpha_y * n.y, std::max(0.0, n.z)).normalized() * side;
}

double visible_normal_pdf(const TrowbridgeReitz& d, const Vec3d& wo, const Vec3d& wh) {
  return distribution(d, wh) * masking(d, wo) * std::abs(wo ^ wh) / abs_cos(wo);
}

double alpha_of_roughness_v3(double roughness) {
  const double x = std::log(std::max(roughness, 1e-3));
  return 1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)));
}

double alpha_of_roughness_v4(double roughness) {
  return std::sqrt(std::max(0.0, roughness));
}

}  // namespace penumbra

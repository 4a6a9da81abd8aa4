#include "scenes/quadrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace penumbra {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

absl::StatusOr<double> radius_of(const ShapeEntity& shape, const SceneDescription& description) {
  const double radius = shape.params.number("radius", 1);
  if (radius > 0) return radius;
  return invalid_input("{}: {} of radius {}: it must be positive", description.place(shape.loc), shape.type,
                       radius);
}

/// pbrt clamps the sweep to [0°, 360°].
absl::StatusOr<double> phi_max_of(const ShapeEntity& shape, const SceneDescription& description) {
  const double degrees = std::min(shape.params.number("phimax", 360), 360.0);
  if (degrees == 360) return kTurn;
  if (degrees > 0) return degrees * (std::numbers::pi / 180);
  return invalid_input("{}: phimax of {}° leaves nothing of the {}", description.place(shape.loc), degrees,
                       shape.type);
}

/// zmin and zmax in order.
absl::Status order_bounds(double& z_min, double& z_max, const ShapeEntity& shape,
                          const SceneDescription& description) {
  if (z_max < z_min) std::swap(z_min, z_max);
  if (z_min < z_max) return absl::OkStatus();
  return invalid_input("{}: zmin and zmax leave nothing of the {}", description.place(shape.loc), shape.type);
}

int steps_for(double angle, double whole, int whole_steps) {
  // Rounding of an angle must not cost a step of its own.
  constexpr double kJustBelow = 1 - 16 * std::numeric_limits<double>::epsilon();
  return std::max(1, static_cast<int>(std::ceil(whole_steps * (angle / whole) * kJustBelow)));
}

struct SurfaceVertex {
  Vec3d p, n;
};

/// A grid of (nu+1) × (nv+1) vertices over uv ∈ [0,1]², triangles towards ∂p/∂u × ∂p/∂v. Cells that
/// shrink to a triangle at v = 0 or v = 1 (a pole, a centre) get one.
template <class Surface>
TriangleMesh grid(int nu, int nv, bool point_at_v0, bool point_at_v1, Surface&& surface) {
  TriangleMesh mesh;
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i <= nu; ++i) {
      const double u = static_cast<double>(i) / nu, v = static_cast<double>(j) / nv;
      const SurfaceVertex vertex = surface(u, v);
      mesh.positions.emplace_back(vertex.p);
      mesh.normals.emplace_back(vertex.n);
      mesh.uvs.emplace_back(Vec2d(u, v));
    }
  const auto row = static_cast<uint32_t>(nu + 1);
  for (uint32_t j = 0; j < static_cast<uint32_t>(nv); ++j)
    for (uint32_t i = 0; i + 1 < row; ++i) {
      const uint32_t p00 = j * row + i, p10 = p00 + 1, p01 = p00 + row, p11 = p01 + 1;
      // Where v = 0 is a point, p00 and p10 coincide; where v = 1 is one, p01 and p11 do.
      const bool top_is_point = point_at_v1 && j + 1 == static_cast<uint32_t>(nv);
      if (!(point_at_v0 && j == 0)) mesh.indices.insert(mesh.indices.end(), {p00, p10, p11});
      if (!top_is_point) mesh.indices.insert(mesh.indices.end(), {p00, p11, p01});
    }
  return mesh;
}

}  // namespace

bool Sphere::full() const {
  return z_min == -radius && z_max == radius && phi_max == kTurn;
}
bool Disk::full() const {
  return inner == 0 && phi_max == kTurn;
}
bool Cylinder::full() const {
  return phi_max == kTurn;
}

absl::StatusOr<Sphere> sphere_of(const ShapeEntity& shape, const SceneDescription& description) {
  Sphere sphere;
  ASSIGN_OR_RETURN(sphere.radius, radius_of(shape, description));
  ASSIGN_OR_RETURN(sphere.phi_max, phi_max_of(shape, description));
  // As pbrt: bounds beyond the poles mean the poles.
  sphere.z_min = std::clamp(shape.params.number("zmin", -sphere.radius), -sphere.radius, sphere.radius);
  sphere.z_max = std::clamp(shape.params.number("zmax", sphere.radius), -sphere.radius, sphere.radius);
  RETURN_IF_ERROR(order_bounds(sphere.z_min, sphere.z_max, shape, description));
  return sphere;
}

absl::StatusOr<Disk> disk_of(const ShapeEntity& shape, const SceneDescription& description) {
  Disk disk;
  ASSIGN_OR_RETURN(disk.radius, radius_of(shape, description));
  ASSIGN_OR_RETURN(disk.phi_max, phi_max_of(shape, description));
  disk.height = shape.params.number("height", 0);
  disk.inner = shape.params.number("innerradius", 0);
  if (disk.inner >= 0 && disk.inner < disk.radius) return disk;
  return invalid_input("{}: disk with an inner radius of {} outside [0, {})", description.place(shape.loc),
                       disk.inner, disk.radius);
}

absl::StatusOr<Cylinder> cylinder_of(const ShapeEntity& shape, const SceneDescription& description) {
  Cylinder cylinder;
  ASSIGN_OR_RETURN(cylinder.radius, radius_of(shape, description));
  ASSIGN_OR_RETURN(cylinder.phi_max, phi_max_of(shape, description));
  cylinder.z_min = shape.params.number("zmin", -1);
  cylinder.z_max = shape.params.number("zmax", 1);
  RETURN_IF_ERROR(order_bounds(cylinder.z_min, cylinder.z_max, shape, description));
  return cylinder;
}

TriangleMesh mesh_of(const Sphere& sphere) {
  // θ from +z; v runs from z_min up to z_max, as pbrt's.
  const double theta_at_min = std::acos(sphere.z_min / sphere.radius);
  const double theta_at_max = std::acos(sphere.z_max / sphere.radius);
  const int nu = steps_for(sphere.phi_max, kTurn, kTurnSteps);
  const int nv = steps_for(theta_at_min - theta_at_max, std::numbers::pi, kPoleSteps);
  const bool south = sphere.z_min == -sphere.radius, north = sphere.z_max == sphere.radius;
  return grid(nu, nv, south, north, [&](double u, double v) {
    const double phi = u == 1 && sphere.phi_max == kTurn ? 0 : u * sphere.phi_max;
    const double theta = theta_at_min + v * (theta_at_max - theta_at_min);
    const double ring = (v == 0 && south) || (v == 1 && north) ? 0 : std::sin(theta);
    const Vec3d n(ring * std::cos(phi), ring * std::sin(phi), std::cos(theta));
    return SurfaceVertex{n * sphere.radius, n};
  });
}

TriangleMesh mesh_of(const Disk& disk) {
  const int nu = steps_for(disk.phi_max, kTurn, kTurnSteps);
  // An N-gon of circumradius R has the area N/2 R² sin(2π/N); this R makes it π r².
  const double step = disk.phi_max / nu;
  const double outwards = disk.full() ? std::sqrt(step / std::sin(step)) : 1;
  return grid(nu, 1, false, disk.inner == 0, [&](double u, double v) {
    const double phi = u == 1 && disk.phi_max == kTurn ? 0 : u * disk.phi_max;
    const double r = outwards * (v == 0 ? disk.radius : disk.inner);
    return SurfaceVertex{{r * std::cos(phi), r * std::sin(phi), disk.height}, {0, 0, 1}};
  });
}

TriangleMesh mesh_of(const Cylinder& cylinder) {
  const int nu = steps_for(cylinder.phi_max, kTurn, kTurnSteps);
  return grid(nu, 1, false, false, [&](double u, double v) {
    const double phi = u == 1 && cylinder.phi_max == kTurn ? 0 : u * cylinder.phi_max;
    const Vec3d n(std::cos(phi), std::sin(phi), 0);
    return SurfaceVertex{n * cylinder.radius + Vec3d(0, 0, v == 0 ? cylinder.z_min : cylinder.z_max), n};
  });
}

TriangleMesh unit_sphere() {
  return mesh_of(Sphere{1, -1, 1, kTurn});
}

MeshOr make_sphere(const ShapeEntity& shape, const MeshContext& context) {
  ASSIGN_OR_RETURN(const Sphere sphere, sphere_of(shape, context.description));
  return mesh_of(sphere);
}

MeshOr make_disk(const ShapeEntity& shape, const MeshContext& context) {
  ASSIGN_OR_RETURN(const Disk disk, disk_of(shape, context.description));
  return mesh_of(disk);
}

MeshOr make_cylinder(const ShapeEntity& shape, const MeshContext& context) {
  ASSIGN_OR_RETURN(const Cylinder cylinder, cylinder_of(shape, context.description));
  return mesh_of(cylinder);
}

}  // namespace penumbra

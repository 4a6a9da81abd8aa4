#pragma once
// pbrt's full and partial spheres, disks and cylinders: their parameters, and meshes of them. Angles in
// radians; object space, axis z.
//
// Error of the meshes. Vertices lie on the surface and normals are the surface's own. A whole turn has
// kTurnSteps steps, so the mesh stays inside by at most r (1 - cos(π/kTurnSteps)) = 7.5e-5 r in each of its
// two directions, and its silhouette's area is 1.0e-4 smaller than the true one. Vertices are not pushed
// out to balance this: a point of the true surface, chosen as a light sample, would then lie behind the
// light's own mesh. The full disk alone is pushed out, so that its area is exact: it is flat, and its
// points lie in its own plane either way.
#include "absl/status/statusor.h"
#include "scenes/mesh.h"
#include "scenes/mesh_makers.h"

namespace penumbra {

constexpr int kTurnSteps = 256;
constexpr int kPoleSteps = 128;  ///< from pole to pole

/// radius > 0; -radius <= z_min < z_max <= radius; 0 < phi_max <= 2π.
struct Sphere {
  double radius = 1, z_min = -1, z_max = 1, phi_max = 0;
  bool full() const;
};
/// Annulus at z = height; 0 <= inner < radius.
struct Disk {
  double height = 0, radius = 1, inner = 0, phi_max = 0;
  bool full() const;  ///< no hole and a whole turn
};
/// Open tube; z_min < z_max.
struct Cylinder {
  double radius = 1, z_min = -1, z_max = 1, phi_max = 0;
  bool full() const;
};

/// Parameters with pbrt's defaults and its order of bounds; InvalidArgument for what has no surface.
absl::StatusOr<Sphere> sphere_of(const ShapeEntity& shape, const SceneDescription& description);
absl::StatusOr<Disk> disk_of(const ShapeEntity& shape, const SceneDescription& description);
absl::StatusOr<Cylinder> cylinder_of(const ShapeEntity& shape, const SceneDescription& description);

/// Normals point outwards (a disk's to +z); uv as pbrt has them.
TriangleMesh mesh_of(const Sphere& sphere);
TriangleMesh mesh_of(const Disk& disk);
TriangleMesh mesh_of(const Cylinder& cylinder);

/// The full sphere of radius 1, for many instances of one mesh.
TriangleMesh unit_sphere();

}  // namespace penumbra

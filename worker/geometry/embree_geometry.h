#pragma once
// What a scene of Embree's is made of: committed geometries, one for each mesh, tube or standing instance.
#include "scenes/curve.h"
#include "worker/geometry/embree.h"
#include "worker/geometry/geometry.h"

namespace penumbra {

/// Copies the mesh; null if there is no memory. `alpha` (null: opaque) must outlive it.
GeometryHandle make_triangles(RTCDevice device, const TriangleMesh& mesh, const AlphaTest* alpha);
/// Keeps the tubes' arrays; null if there is no memory. Chains of cone-spheres; the inside of a chain is no
/// surface.
GeometryHandle make_tubes(RTCDevice device, const Tubes& tubes);
GeometryHandle make_instance(RTCDevice device, RTCScene object, const Matrix& to_world);

}  // namespace penumbra

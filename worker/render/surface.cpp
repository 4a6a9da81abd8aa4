#include "worker/render/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/geometry/pose.h"
#include "worker/render/tube_surface.h"
#include "worker/sampling/warp.h"

namespace penumbra {
namespace {

/// Bound of the relative error of n floating-point operations (Higham 2002, §3.1).
constexpr float gamma(int n) {
  constexpr float unit = std::numeric_limits<float>::epsilon() / 2;
  return float(n) * unit / (1 - float(n) * unit);
}

Vec3f abs(const Vec3f& v) {
  return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}

template <class T>
T blend(const std::vector<T>& values, const uint32_t* index, float b0, float b1, float b2) {
  return values[index[0]] * b0 + values[index[1]] * b1 + values[index[2]] * b2;
}

struct Triangle {
  Vec3f p0, p1, p2;
  Vec2f uv0, uv1, uv2;
};

Triangle triangle_of(const TriangleMesh& mesh, const uint32_t* index) {
  Triangle t{
      mesh.positions[index[0]], mesh.positions[index[1]], mesh.positions[index[2]], {0, 0}, {1, 0}, {1, 1}};
  if (!mesh.uvs.empty()) {
    t.uv0 = mesh.uvs[index[0]];
    t.uv1 = mesh.uvs[index[1]];
    t.uv2 = mesh.uvs[index[2]];
  }
  return t;
}

/// Partial derivatives over uv of something linear on the triangle, given its edges' differences:
/// solves [du02 dv02; du12 dv12] [d/du; d/dv] = [d02; d12]. False where uv is degenerate.
bool partials(const Triangle& t, const Vec3f& d02, const Vec3f& d12, Vec3f& du, Vec3f& dv) {
  const Vec2f uv02 = t.uv0 - t.uv2, uv12 = t.uv1 - t.uv2;
  const double determinant = double(uv02.x) * uv12.y - double(uv02.y) * uv12.x;
  if (determinant == 0) return false;
  const float inverse = float(1 / determinant);
  du = (d02 * uv12.y - d12 * uv02.y) * inverse;
  dv = (d12 * uv02.x - d02 * uv12.x) * inverse;
  return std::isfinite(du.length2()) && std::isfinite(dv.length2());
}

/// An instance at the time of a hit.
struct Placed {
  const Matrix& to_world;
  const Imath::M33d& normals;

  static Placed at(const SceneInstance& instance, float time) {
    if (!instance.motion) return {instance.to_world, instance.normals};
    const Pose& pose = pose_at(*instance.motion, time);
    return {pose.to_world, pose.normals};
  }
};

/// Carries a point of object space and its error bound to the world (pbrt-v3 §3.9.4).
void to_world(SurfacePoint& point, const Placed& placed) {
  const Matrix& m = placed.to_world;
  Vec3d world;
  m.multVecMatrix(Vec3d(point.p), world);
  Vec3f error;
  for (int j = 0; j < 3; ++j) {
    double sum = std::abs(m[3][j]), moved = 0;
    for (int i = 0; i < 3; ++i) {
      sum += std::abs(m[i][j] * point.p[i]);
      moved += std::abs(m[i][j]) * point.p_error[i];
    }
    error[j] = float(gamma(3) * sum + (1 + gamma(3)) * moved);
  }
  point.p = Vec3f(world);
  point.p_error = error;
  for (Vec3f* v : {&point.dpdu, &point.dpdv}) {
    Vec3d out;
    m.multDirMatrix(Vec3d(*v), out);
    *v = Vec3f(out);
  }
  for (Vec3f* n : {&point.dndu, &point.dndv}) *n = Vec3f(Vec3d(*n) * placed.normals);
}

void set_footprint(SurfacePoint& point, const CameraRay& ray) {
  constexpr float kShare = 0.25f;
  const auto meet = [&](const Vec3f& direction, Vec3f& d) {
    const float along = point.ng.dot(direction);
    const float t = point.ng.dot(point.p - ray.origin) / along;
    if (along == 0 || !std::isfinite(t)) return false;
    d = (ray.origin + direction * t - point.p) * kShare;
    return true;
  };
  if (!meet(ray.direction_dx, point.dpdx) || !meet(ray.direction_dy, point.dpdy)) {
    point.dpdx = point.dpdy = Vec3f(0);
    return;
  }
  // [dpdu dpdv] [du; dv] = dp, in the least-squares sense: dp lies in the tangent plane but for rounding.
  const double uu = point.dpdu.length2(), vv = point.dpdv.length2(), uv = point.dpdu.dot(point.dpdv);
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 0)) return;
  const auto solve = [&](const Vec3f& dp, float& du, float& dv) {
    const double u = point.dpdu.dot(dp), v = point.dpdv.dot(dp);
    const double a = (u * vv - v * uv) / determinant, b = (v * uu - u * uv) / determinant;
    du = std::isfinite(a) ? float(a) : 0;
    dv = std::isfinite(b) ? float(b) : 0;
  };
  solve(point.dpdx, point.dudx, point.dvdx);
  solve(point.dpdy, point.dudy, point.dvdy);
}

/// pbrt-v3's shading geometry of meshes with vertex normals (triangle.cpp): unit tangents, turned by a half,
/// in place of the derivatives. It scales bump maps there, so pictures of pbrt scenes depend on it.
void set_shading_tangents(SurfacePoint& point) {
  const Vec3f t = point.dpdu.normalized().cross(point.ns);
  if (!(t.length2() > 0)) return;
  point.dpdv = t.normalized();
  point.dpdu = point.dpdv.cross(point.ns);
}

}  // namespace

SurfacePoint surface_at(const Scene& scene, const Hit& hit, const Vec3f& direction,
                        const CameraRay* footprint) {
  const SceneMesh& scene_mesh = scene.meshes[hit.id.mesh];
  if (scene_mesh.tubes) return tube_surface_at(*scene_mesh.tubes, hit, direction);
  const TriangleMesh& mesh = scene_mesh.mesh;
  const uint32_t* index = &mesh.indices[size_t(hit.id.primitive) * 3];
  const Triangle t = triangle_of(mesh, index);
  const SceneInstance* instance = hit.id.instance == kNone ? nullptr : &scene.instances[hit.id.instance];
  const float b1 = hit.u, b2 = hit.v, b0 = 1 - b1 - b2;

  SurfacePoint point;
  point.id = hit.id;
  point.time = hit.time;
  point.dndu = point.dndv = point.dpdx = point.dpdy = Vec3f(0);
  point.wo = -direction;
  point.p = t.p0 * b0 + t.p1 * b1 + t.p2 * b2;
  // Rounding of the blend, and of what a ray that starts here computes for its distance to this very
  // triangle: n · (p0 - origin), where n, a cross product of the edges, is off by a few units of rounding in
  // every direction, so that the whole extent of the triangle enters and not its extent along n alone.
  const float extent = std::max({(t.p1 - t.p0).length(), (t.p2 - t.p0).length(), (t.p2 - t.p1).length()});
  point.p_error = (abs(t.p0 * b0) + abs(t.p1 * b1) + abs(t.p2 * b2)) * gamma(7) + Vec3f(extent * gamma(8));
  point.uv = t.uv0 * b0 + t.uv1 * b1 + t.uv2 * b2;
  const bool has_uv = partials(t, t.p0 - t.p2, t.p1 - t.p2, point.dpdu, point.dpdv);

  // Double: the cross product of a sliver's edges keeps its direction.
  Vec3d ng = (Vec3d(t.p1) - Vec3d(t.p0)).cross(Vec3d(t.p2) - Vec3d(t.p0)).normalized();
  if (scene_mesh.flip) ng = -ng;
  Vec3d ns = ng;
  if (!mesh.normals.empty()) {
    const Vec3d blended(blend(mesh.normals, index, b0, b1, b2));
    if (blended.length2() > 0) {
      ns = blended.normalized();
      if (ng.dot(ns) < 0) ng = -ng;  // vertex normals decide the side, as in pbrt
      const Vec3f n02 = mesh.normals[index[0]] - mesh.normals[index[2]];
      const Vec3f n12 = mesh.normals[index[1]] - mesh.normals[index[2]];
      if (!partials(t, n02, n12, point.dndu, point.dndv)) point.dndu = point.dndv = Vec3f(0);
    }
  }
  if (instance) {
    const Placed placed = Placed::at(*instance, hit.time);
    to_world(point, placed);
    ng = (ng * placed.normals).normalized();
    ns = (ns * placed.normals).normalized();
  }
  point.ng = Vec3f(ng);
  point.ns = Vec3f(ns);
  if (!has_uv || point.dpdu.cross(point.dpdv).length2() == 0) {
    Vec3d s, r;
    frame(ng, s, r);
    point.dpdu = Vec3f(s);
    point.dpdv = Vec3f(r);
  }
  if (footprint) set_footprint(point, *footprint);
  if (!mesh.normals.empty()) set_shading_tangents(point);
  return point;
}

}  // namespace penumbra

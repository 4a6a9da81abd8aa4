#include "worker/render/light_pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/lights/moving_light.h"
#include "worker/render/camera_stage.h"

namespace penumbra {
namespace {

/// A convex polygon of the image plane, pixels; a triangle cut by the camera's plane has up to four corners.
struct Outline {
  Vec2d corners[4];
  int count = 0;
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;  ///< depths of the corners
  Vec2d lo{std::numeric_limits<double>::infinity()}, hi{-std::numeric_limits<double>::infinity()};

  void add(const Vec3d& homogeneous) {
    const Vec2d p = Vec2d(homogeneous.x, homogeneous.y) / homogeneous.z;
    corners[count++] = p;
    nearest = std::min(nearest, homogeneous.z);
    farthest = std::max(farthest, homogeneous.z);
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y)};
  }

  /// Separating axes of two convex polygons: no edge of this one has the whole rectangle on its outer side.
  /// The rectangle's own axes are those of lo and hi, which the caller has tried.
  bool meets(const Vec2d& centre, const Vec2d& radius) const {
    double area = 0;
    for (int i = 0; i < count; ++i) area += corners[i].cross(corners[(i + 1) % count]);
    const double turn = area < 0 ? -1 : 1;
    for (int i = 0; i < count; ++i) {
      const Vec2d edge = (corners[(i + 1) % count] - corners[i]) * turn;
      const double reach = std::abs(edge.x) * radius.y + std::abs(edge.y) * radius.x;
      if (edge.cross(centre - corners[i]) < -reach) return false;
    }
    return true;
  }
};

/// The triangle's projection. Corners behind the camera are cut off at a depth of single precision's roundoff
/// relative to the deepest corner.
Outline project(const Camera& camera, const Vec3d (&triangle)[3]) {
  Vec3d h[3];
  for (int i = 0; i < 3; ++i) h[i] = camera.project(triangle[i]);
  const double deepest = std::max({h[0].z, h[1].z, h[2].z});
  Outline outline;
  if (!(deepest > 0)) return outline;
  const double nearest = deepest * std::numeric_limits<float>::epsilon();
  for (int i = 0; i < 3; ++i) {
    const Vec3d &a = h[i], &b = h[(i + 1) % 3];
    if (a.z >= nearest) outline.add(a);
    if ((a.z >= nearest) != (b.z >= nearest)) outline.add(a + (b - a) * ((nearest - a.z) / (b.z - a.z)));
  }
  return outline;
}

/// First and last+1 pixel, within [lo,hi), whose filter may reach into [from,to].
std::pair<int, int> pixels_over(double from, double to, double radius, int lo, int hi) {
  const double first = std::clamp(std::floor(from - radius - 0.5), double(lo), double(hi));
  const double last = std::clamp(std::ceil(to + radius + 0.5), double(lo), double(hi));
  return {int(first), int(last)};
}

void mark(const Outline& outline, const Vec2d& radius, const PixelRect& tile, std::vector<uint8_t>& marks) {
  const auto [x0, x1] = pixels_over(outline.lo.x, outline.hi.x, radius.x, tile.x0, tile.x1);
  const auto [y0, y1] = pixels_over(outline.lo.y, outline.hi.y, radius.y, tile.y0, tile.y1);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x)
      if (outline.meets(Vec2d(x + 0.5, y + 0.5), radius))
        marks[size_t(y - tile.y0) * tile.width() + x - tile.x0] = 1;
}

/// How far from its projection the light may leave a trace: the filter's radius, and the blur of what is
/// between the depths of the outline, which is largest at one of them (a lens focuses at one depth and blurs
/// more either way).
Vec2d reach(const Scene& scene, const Camera& camera, const Outline& outline) {
  const Vec2d filter = scene.filter->radius();
  const CameraStage* stage = scene.effects.camera.get();
  if (!stage) return filter;
  return filter +
         Vec2d(std::max(stage->blur(outline.nearest), stage->blur(outline.farthest))) / camera.pixel_size();
}

/// The sides of a box, two triangles each.
template <class Use>
void each_side(const Imath::Box3d& box, const Use& use) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double at : {box.min[axis], box.max[axis]}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      Vec3d corners[4];
      for (int c = 0; c < 4; ++c) {
        corners[c][axis] = at;
        corners[c][u] = c == 1 || c == 2 ? box.max[u] : box.min[u];
        corners[c][v] = c >= 2 ? box.max[v] : box.min[v];
      }
      use({corners[0], corners[1], corners[2]});
      use({corners[0], corners[2], corners[3]});
    }
}

/// A light that moves: wherever it is while the shutter is open it lies within two boxes that follow each
/// other.
template <class Use>
void each_place(const LightMotion& motion, const Use& use) {
  const LightBounds object = bounds_of(AreaEmitter{motion.in_object, Rgb(0)});
  const std::vector<MovedBox> boxes = motion.to_world.boxes({object.lo, object.hi});
  for (size_t i = 1; i < boxes.size(); ++i) {
    Imath::Box3d both(boxes[i - 1].lo, boxes[i - 1].hi);
    both.extendBy(Imath::Box3d(boxes[i].lo, boxes[i].hi));
    each_side(both, use);
  }
}

}  // namespace

std::vector<uint8_t> light_pixels(const Scene& scene, const Camera& camera, const PixelRect& tile) {
  std::vector<uint8_t> marks(size_t(tile.area()), 0);
  if (scene.lights.area.size() > kMostProjectedLights) return marks;
  const auto mark_triangle = [&](const Vec3d(&triangle)[3]) {
    const Outline outline = project(camera, triangle);
    if (outline.count > 0) mark(outline, reach(scene, camera, outline), tile, marks);
  };
  for (const AreaEmitter& emitter : scene.lights.area) {
    if (emitter.invisible) continue;
    if (emitter.motion) {
      each_place(*emitter.motion, mark_triangle);
      continue;
    }
    const TriangleMesh& mesh = scene.meshes[emitter.mesh].mesh;
    for (uint32_t t = emitter.first_primitive; t < emitter.first_primitive + emitter.primitives; ++t) {
      const uint32_t* i = &mesh.indices[size_t{t} * 3];
      const Vec3d triangle[3] = {Vec3d(mesh.positions[i[0]]), Vec3d(mesh.positions[i[1]]),
                                 Vec3d(mesh.positions[i[2]])};
      mark_triangle(triangle);
    }
  }
  return marks;
}

}  // namespace penumbra

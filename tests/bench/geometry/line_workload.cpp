#include "tests/bench/geometry/line_workload.h"

#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "worker/geometry/surface_point.h"

namespace penumbra::bench {
namespace {

constexpr int kTile = 16;

class Generator {
 public:
  Generator(const Geometry& geometry, const BenchScene& scene, int lines, uint32_t seed)
      : geometry_(geometry), scene_(scene), lines_(lines), random_(seed) {}

  float uniform() { return std::uniform_real_distribution<float>(0, 1)(random_); }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }

  std::optional<ShadingPoint> at_pixel(float px, float py) {
    const auto& camera = scene_.camera;
    Ray ray;
    ray.origin = camera.origin;
    ray.direction = camera.forward + camera.right * (2 * px / static_cast<float>(camera.width) - 1) +
                    camera.up * (1 - 2 * py / static_cast<float>(camera.height));
    ray.near = 0;
    ray.far = std::numeric_limits<float>::infinity();
    const auto hit = geometry_.intersect(ray, counters_);
    if (!hit || hit->id.instance != kNone) return std::nullopt;
    const SurfacePoint surface = surface_at(*hit, ray.direction);
    const auto index = static_cast<size_t>(below(static_cast<int>(scene_.lights.size())));
    const auto& light = scene_.lights[index];
    const Vec3f x = surface.offset(-ray.direction);
    if ((x - light.o).dot(light.u.cross(light.v)) <= 0) return std::nullopt;
    ShadingPoint point;
    point.normal = surface.ng;
    point.light = index;
    for (int i = 0; i < lines_; ++i) add_line(point, light, x, surface.ng);
    if (point.lines.size() != static_cast<size_t>(lines_)) return std::nullopt;
    return point;
  }

 private:
  /// As the renderer makes it: position from barycentrics and its error bound, gamma(7) Σ|b_i p_i|.
  SurfacePoint surface_at(const Hit& hit, const Vec3f& direction) const {
    const TriangleMesh& mesh = scene_.meshes[hit.id.mesh];
    const Vec3f* p[3];
    for (int c = 0; c < 3; ++c) p[c] = &mesh.positions[mesh.indices[3 * size_t{hit.id.primitive} + c]];
    const float b[3] = {1 - hit.u - hit.v, hit.u, hit.v};
    const double u = 0x1p-24;
    SurfacePoint s;
    s.p = *p[0] * b[0] + *p[1] * b[1] + *p[2] * b[2];
    for (int k = 0; k < 3; ++k) {
      const float size =
          std::abs(b[0] * (*p[0])[k]) + std::abs(b[1] * (*p[1])[k]) + std::abs(b[2] * (*p[2])[k]);
      s.p_error[k] = static_cast<float>(7 * u / (1 - 7 * u)) * size;
    }
    s.ng = (*p[1] - *p[0]).cross(*p[2] - *p[0]).normalized();
    if (s.ng.dot(direction) > 0) s.ng = -s.ng;
    return s;
  }

  void add_line(ShadingPoint& point, const BenchScene::Quad& light, const Vec3f& x, const Vec3f& n) {
    const bool along_u = below(2) == 0;
    Vec3f a = light.o + (along_u ? light.v : light.u) * uniform();
    Vec3f b = a + (along_u ? light.u : light.v);
    const float ha = (a - x).dot(n), hb = (b - x).dot(n);
    if (ha <= 0 && hb <= 0) return;
    if (ha < 0) a += (b - a) * (ha / (ha - hb));
    if (hb < 0) b += (a - b) * (hb / (hb - ha));
    const Vec3d on_light = Vec3d(a) + (Vec3d(b) - Vec3d(a)) * double{uniform()};
    const Vec3d normal = Vec3d(light.u).cross(Vec3d(light.v)).normalized();
    const LightPlace place = geometry_.place_of(light.id, light.primitives, normal);
    const LightPlane plane{normal, place.rounding};
    point.lines.push_back({x, a, b, light.id, light.primitives, plane});
    point.points.push_back({on_light, plane, light.id, light.primitives, place.crowded});
  }

  const Geometry& geometry_;
  const BenchScene& scene_;
  int lines_;
  std::mt19937 random_;
  QueryCounters counters_;
};

}  // namespace

std::vector<MeshInput> BenchScene::inputs() const {
  std::vector<MeshInput> result;
  for (const TriangleMesh& mesh : meshes) result.push_back({&mesh});
  return result;
}

std::vector<ShadingPoint> tile_coherent_points(const Geometry& geometry, const BenchScene& scene,
                                               size_t count, int lines, uint32_t seed) {
  Generator generator(geometry, scene, lines, seed);
  std::vector<ShadingPoint> points;
  const int across = (scene.camera.width + kTile - 1) / kTile,
            down = (scene.camera.height + kTile - 1) / kTile;
  size_t tiles_without = 0;
  while (points.size() < count && tiles_without < 100000) {
    const int tx = generator.below(across), ty = generator.below(down);
    ++tiles_without;
    for (int k = 0; k < kTile * kTile && points.size() < count; ++k) {
      const float px = static_cast<float>(tx * kTile + k % kTile) + generator.uniform();
      const float py = static_cast<float>(ty * kTile + k / kTile) + generator.uniform();
      if (px >= static_cast<float>(scene.camera.width) || py >= static_cast<float>(scene.camera.height))
        continue;
      if (auto point = generator.at_pixel(px, py)) {
        points.push_back(std::move(*point));
        tiles_without = 0;
      }
    }
  }
  return points;
}

}  // namespace penumbra::bench

#include "worker/geometry/geometry.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <new>

#include "proto/status.h"
#include "worker/geometry/bow_tie_walk.h"
#include "worker/geometry/embree_scene.h"
#include "worker/geometry/light_end.h"
#include "worker/geometry/line_fan.h"
#include "worker/geometry/line_query.h"
#include "worker/geometry/shaft_list.h"
#include "worker/geometry/swept_ray_walk.h"

namespace penumbra {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Whole chords, but for those seen end on.
void all_visible(std::span<const LineQuery> queries, std::vector<IntervalSet>& out) {
  out.resize(queries.size());
  for (size_t i = 0; i < queries.size(); ++i) {
    const Vec3d x(queries[i].x);
    out[i].clear();
    if (has_area(Vec3d(queries[i].a) - x, Vec3d(queries[i].b) - x)) out[i].reset();
  }
}

}  // namespace

struct Geometry::Parts {
  std::unique_ptr<EmbreeScene> embree;
  LinePath path = widest_line_path();
  double embree_seconds = 0;
  std::atomic<double> line_bvh_seconds{0};  ///< read while another thread builds

  /// The line hierarchy, built at the first call: a job without lines does not pay for it.
  const LineBvh& lines() {
    std::call_once(lines_once, [this] { build_lines(); });
    return line_bvh;
  }

  // What it is built from; empty once it is.
  std::vector<MeshInput> meshes;
  std::vector<ObjectInput> objects;
  std::vector<InstanceInput> instances;
  int threads = 1;

 private:
  void build_lines();

  std::once_flag lines_once;
  LineBvh line_bvh;
};

void Geometry::Parts::build_lines() {
  const auto start = std::chrono::steady_clock::now();
  absl::StatusOr<LineBvh> built = build_line_bvh(meshes, objects, instances, threads);
  // Geometry::build() has checked the input: only memory is left to fail.
  if (!built.ok()) throw std::bad_alloc();
  line_bvh = *std::move(built);
  meshes = {}, objects = {}, instances = {};
  line_bvh_seconds = seconds_since(start);
}

Geometry::Geometry() : parts_(std::make_unique<Parts>()) {}
Geometry::Geometry(Geometry&&) noexcept = default;
Geometry& Geometry::operator=(Geometry&&) noexcept = default;
Geometry::~Geometry() = default;

absl::StatusOr<Geometry> Geometry::build(std::span<const MeshInput> meshes,
                                         std::span<const ObjectInput> objects,
                                         std::span<const InstanceInput> instances, int threads) {
  PENUMBRA_CHECK(threads > 0);
  Geometry geometry;
  RETURN_IF_ERROR(check_line_input(meshes, instances));
  Parts& parts = *geometry.parts_;
  const auto start = std::chrono::steady_clock::now();
  ASSIGN_OR_RETURN(parts.embree, EmbreeScene::build(meshes, objects, instances, threads));
  parts.embree_seconds = seconds_since(start);
  parts.meshes.assign(meshes.begin(), meshes.end());
  parts.objects.assign(objects.begin(), objects.end());
  parts.instances.assign(instances.begin(), instances.end());
  parts.threads = threads;
  return geometry;
}

void Geometry::prepare_lines() const {
  parts_->lines();
}

std::optional<Hit> Geometry::intersect(const Ray& ray, QueryCounters& counters) const {
  ++counters.rays;
  return parts_->embree->intersect(ray);
}

void Geometry::beside(const Ray& ray, const Hit& first, const std::vector<bool>& marked,
                      std::vector<Meeting>& out, QueryCounters& counters) const {
  ++counters.rays;
  parts_->embree->beside(ray, first, marked, out);
}

bool Geometry::occluded(const Vec3f& x, const Vec3f& y, QueryCounters& counters, float time) const {
  ++counters.rays;
  return parts_->embree->occluded(x, y, time);
}

bool Geometry::occluded(const Vec3f& x, const LightEnd& y, QueryCounters& counters) const {
  ++counters.rays;
  return parts_->embree->occluded(x, y);
}

bool Geometry::occluded_by_alpha(const Vec3f& x, const Vec3f& y, QueryCounters& counters, float time) const {
  if (!parts_->embree->has_alpha()) return false;
  ++counters.rays;
  return parts_->embree->occluded_by_alpha(x, y, time);
}

bool Geometry::occluded_by_alpha(const Vec3f& x, const LightEnd& y, QueryCounters& counters) const {
  if (!parts_->embree->has_alpha()) return false;
  ++counters.rays;
  return parts_->embree->occluded_by_alpha(x, y);
}

bool Geometry::has_alpha() const {
  return parts_->embree->has_alpha();
}

bool Geometry::in_hole(const PrimitiveId& first, uint32_t primitives, const Vec3d& p, float time) const {
  return parts_->embree->in_hole(first, primitives, p, time);
}

LightPlace Geometry::place_of(const PrimitiveId& light, uint32_t primitives, const Vec3d& normal) const {
  PENUMBRA_CHECK(light.instance == kNone);
  const Imath::Box3f box = parts_->embree->bounds(light, primitives);
  const Vec3d lo(box.min), hi(box.max), extent = hi - lo;
  Vec3d own = extent * 2;
  for (int k = 0; k < 3; ++k) own[k] += std::max(std::abs(lo[k]), std::abs(hi[k]));
  LightPlace place{rounding_along(normal, own), true};
  Vec3f scene_lo, scene_hi;
  bounds(scene_lo, scene_hi);
  const Vec3d margin(LightApproach::closest(own, Vec3d(scene_hi) - Vec3d(scene_lo)));
  place.crowded = parts_->embree->anything_meets({lo - margin, hi + margin}, light, primitives, {normal, place.rounding});
  return place;
}

void Geometry::visible(std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                       QueryCounters& counters) const {
  visible_lines(parts_->lines(), parts_->path, queries, out, counters);
}

void Geometry::enter(const ShaftQuery& query, Shaft& shaft, QueryCounters& counters) const {
  shaft.content_ = enter_shaft(parts_->lines(), parts_->path, query, *shaft.parts_, counters);
}

void Geometry::visible(const Shaft& shaft, std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
                       QueryCounters& counters) const {
  switch (shaft.content_) {
    case ShaftContent::kClear:
      return all_visible(queries, out);
    case ShaftContent::kHidden:
      out.resize(queries.size());
      for (IntervalSet& set : out) set.clear();
      return;
    case ShaftContent::kFew:
      return visible_in_list(parts_->lines(), parts_->path, shaft.parts_->list, queries, out, counters);
    case ShaftContent::kMany:
      return visible(queries, out, counters);
  }
}

bool Geometry::occluded(const Shaft& shaft, const Vec3f& x, const LightEnd& y,
                        QueryCounters& counters) const {
  // Alpha-tested meshes are in no list.
  if (shaft.content_ == ShaftContent::kClear) return occluded_by_alpha(x, y, counters);
  return shaft.content_ == ShaftContent::kHidden || occluded(x, y, counters);
}

void Geometry::nearest(const FocusedChord& chord, std::vector<SeenInterval>& out,
                       QueryCounters& counters) const {
  nearest_along(parts_->lines(), chord, out, counters);
}

void Geometry::nearest(const RayInTime& ray, std::vector<SeenInterval>& out, QueryCounters& counters) const {
  nearest_in_time(parts_->lines(), ray, out, counters);
}

Geometry::BuildTimes Geometry::build_times() const {
  return {parts_->embree_seconds, parts_->line_bvh_seconds};
}

double Geometry::line_bytes_per_triangle() const {
  const size_t triangles = parts_->lines().triangles();
  return triangles == 0 ? 0 : static_cast<double>(parts_->lines().bytes()) / static_cast<double>(triangles);
}

void Geometry::bounds(Vec3f& lo, Vec3f& hi) const {
  parts_->embree->bounds(lo, hi);
}

const char* Geometry::isa() const {
  return name_of(parts_->path);
}

}  // namespace penumbra

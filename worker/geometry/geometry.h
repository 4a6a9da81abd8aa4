#pragma once
// The scene's surfaces as the renderer asks for them: nearest hit, shadow segment, line query. The only
// room that knows Embree, behind embree.h: what that is included by traces with it, or builds with it; this
// header and all others know nothing of it.
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/animated_transform.h"
#include "scenes/curve.h"
#include "scenes/mesh.h"
#include "worker/geometry/intervals.h"
#include "worker/geometry/light_plane.h"

namespace penumbra {

constexpr uint32_t kNone = ~uint32_t{0};

/// Decides whether a hit of an alpha-tested mesh counts: primitive of the mesh, barycentric (u,v).
using AlphaTest = std::function<bool(uint32_t primitive, float u, float v)>;

/// A mesh as the scene has it. Geometry keeps a reference to the arrays: they must outlive it.
struct MeshInput {
  const TriangleMesh* mesh = nullptr;  ///< world space, or object space if it belongs to an object
  AlphaTest alpha;                     ///< empty: opaque
  bool visible = true;                 ///< false: no ray and no line meets it (material "interface")
  const Tubes* tubes = nullptr;        ///< in the world; then the mesh is empty, and primitives are segments
};

/// Meshes [first,last) that are placed together by instances, in object space.
struct ObjectInput {
  uint32_t first_mesh = 0, last_mesh = 0;
};

/// Row-vector affine object-to-world of one object.
struct InstanceInput {
  uint32_t object = 0;
  Matrix to_world;                                  ///< at time 0
  std::shared_ptr<const AnimatedTransform> motion;  ///< null: it stands
};

/// Identity of a surface primitive. instance == kNone for what is placed directly in the world.
struct PrimitiveId {
  uint32_t instance = kNone, mesh = kNone, primitive = kNone;
  bool operator==(const PrimitiveId&) const = default;
};

struct Ray {
  Vec3f origin, direction;  ///< direction need not be unit; distances are in its length
  float near = 0, far = 0;
  float time = 0;  ///< of the shutter, in [0,1]: when moving instances are met
};

struct Hit {
  PrimitiveId id;
  float distance = 0;  ///< along the ray, in lengths of its direction
  float u = 0, v = 0;  ///< barycentric: p = (1-u-v) p0 + u p1 + v p2; on tubes see tube.h
  float time = 0;      ///< the ray's
};

/// Where a ray meets a triangle.
struct Meeting {
  PrimitiveId id;
  Vec3d p;  ///< on the triangle, in double precision
};

/// A chord a→b seen from x; a and b lie on (or in the plane of) a light's surface.
struct LineQuery {
  Vec3f x;  ///< already moved off its own surface (see SurfacePoint::offset)
  Vec3f a, b;
  PrimitiveId light;  ///< primitives [light.primitive, light.primitive + light_primitives) of
  uint32_t light_primitives =
      0;             ///< light.mesh never hide the chord: they are the light's own (flat) surface
  LightPlane plane;  ///< what is not before it (light_plane.h) hides nothing
  float time = 0;    ///< as a ray's
};

/// A point of a flat light, where a shadow segment ends. Only what lies before the light's plane by more than
/// the rounding of the vertices (light_plane.h) hides it, as little as that may be.
struct LightEnd {
  Vec3d p;
  LightPlane plane;   ///< known
  PrimitiveId light;  ///< as in LineQuery: the light's own primitives do not hide it
  uint32_t light_primitives = 0;
  bool crowded = true;  ///< LightPlace::crowded; false spares the judging of what is close to the light
  float time = 0;       ///< as a ray's
};

/// How a flat light stands in the scene; found once per light.
struct LightPlace {
  double rounding = 0;  ///< LightPlane::rounding
  /// Something else is so close to it that a ray cannot tell the two apart.
  bool crowded = true;
};

/// A chord a→b of which every point sends one ray, through `focus` and on: a planar bow-tie.
struct FocusedChord {
  Vec3d a, b, focus;
  float time = 0;  ///< as a ray's
  /// The rays begin at the focus: what lies between it and the chord is not met.
  bool from_focus = false;
};

/// One ray at all times of the shutter, carried along by the camera if that moves.
struct RayInTime {
  Vec3d origin, direction;                    ///< when the shutter opens
  const AnimatedTransform* camera = nullptr;  ///< to the world; null: it stands
  Matrix to_camera;                           ///< from the world, when the shutter opens
};

/// What the rays from v in [lo,hi] of a chord, or a ray at these times, meet first; mesh kNone: nothing.
struct SeenInterval {
  double lo = 0, hi = 0;
  PrimitiveId id;
};

/// What line and ray queries cost, for statistics; one per thread.
struct QueryCounters {
  uint64_t rays = 0, line_queries = 0;
  uint64_t nodes_visited = 0, triangles_tested = 0;
};

class Shaft;
struct ShaftQuery;

/// Immutable after build; every query is const and may run on any number of threads.
class Geometry {
 public:
  /// `meshes` not covered by an object are in the world. Builds on `threads` threads: what rays need at once,
  /// what lines and shafts need when one is first asked for, or by prepare_lines().
  static absl::StatusOr<Geometry> build(std::span<const MeshInput> meshes,
                                        std::span<const ObjectInput> objects,
                                        std::span<const InstanceInput> instances, int threads);
  Geometry(Geometry&&) noexcept;
  Geometry& operator=(Geometry&&) noexcept;
  ~Geometry();

  /// Builds what visible() and enter() walk, unless that is done: for a caller whose clock must not pay for
  /// it. Any number of threads may call; they wait for one that builds. std::bad_alloc if memory runs out.
  void prepare_lines() const;

  /// Nearest hit in (near, far].
  std::optional<Hit> intersect(const Ray& ray, QueryCounters& counters) const;

  /// Triangles of the marked meshes that a ray's distances cannot tell from the surface that it met first,
  /// and perhaps that one itself; in no order. Not of instances.
  void beside(const Ray& ray, const Hit& first, const std::vector<bool>& marked, std::vector<Meeting>& out,
              QueryCounters& counters) const;

  /// Anything strictly between x and y? Both already moved off their surfaces. Alpha-tested meshes count.
  bool occluded(const Vec3f& x, const Vec3f& y, QueryCounters& counters, float time = 0) const;

  /// The same for a y on a flat light: anything between x and the light's surface, but not that itself?
  bool occluded(const Vec3f& x, const LightEnd& y, QueryCounters& counters) const;

  /// Like occluded(), but only meshes that a line query cannot see (alpha-tested ones); false without any.
  bool occluded_by_alpha(const Vec3f& x, const Vec3f& y, QueryCounters& counters, float time = 0) const;
  bool occluded_by_alpha(const Vec3f& x, const LightEnd& y, QueryCounters& counters) const;
  bool has_alpha() const;
  /// Is the point p, of `primitives` triangles of an alpha-tested mesh from the given one on, where these are
  /// cut out? `p` need not lie in their plane to the last bit.
  bool in_hole(const PrimitiveId& first, uint32_t primitives, const Vec3d& p, float time) const;
  LightPlace place_of(const PrimitiveId& light, uint32_t primitives, const Vec3d& normal) const;

  /// The visible part of each query's chord as intervals of v in [0,1], P(v) = a + v (b - a); opaque
  /// meshes only. Queries of one call share x (they are traced together where that is faster); the
  /// result of each does not depend on the others. `out` is resized to queries.size().
  void visible(std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
               QueryCounters& counters) const;

  /// Finds what can hide any of a flat light from x; see shaft.h. The shaft then answers for chords and
  /// points of that light as visible() and occluded() do, to the bit, mostly for less.
  void enter(const ShaftQuery& query, Shaft& shaft, QueryCounters& counters) const;
  /// As visible(queries, …), for chords from the shaft's x on the shaft's light, on its side of the horizon.
  void visible(const Shaft& shaft, std::span<const LineQuery> queries, std::vector<IntervalSet>& out,
               QueryCounters& counters) const;
  /// As occluded(x, y), for the shaft's x and a y on its light, on its side of the horizon.
  bool occluded(const Shaft& shaft, const Vec3f& x, const LightEnd& y, QueryCounters& counters) const;

  /// The nearest surface along the rays of a focused chord: ascending intervals that cover [0,1]. Opaque
  /// meshes only, tubes only of rays that begin at the focus, and to within double precision: where the answer decides what is looked at, a ray must
  /// still look. One interval of nothing for a chord seen end on from the focus.
  void nearest(const FocusedChord& chord, std::vector<SeenInterval>& out, QueryCounters& counters) const;

  /// The same for one ray over the times [0,1] of the shutter. What turns is followed in steps
  /// (swept_ray_walk.cpp): its intervals are off by the square of a step. One interval of nothing where
  /// nothing that moves is met.
  void nearest(const RayInTime& ray, std::vector<SeenInterval>& out, QueryCounters& counters) const;

  struct BuildTimes {
    double embree_seconds = 0, line_bvh_seconds = 0;
  };
  /// The line BVH's are 0 until it is built.
  BuildTimes build_times() const;
  /// Of the line BVH, per triangle.
  double line_bytes_per_triangle() const;
  /// Bounds of everything at all times; min > max if empty.
  void bounds(Vec3f& lo, Vec3f& hi) const;
  /// Widest instruction set that line queries use here: "avx512", "avx2" or "scalar".
  const char* isa() const;

 private:
  Geometry();
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace penumbra

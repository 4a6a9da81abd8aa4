#pragma once
// The work that line queries are measured on: what a renderer's first bounce asks of its quad lights.
#include <vector>

#include "worker/geometry/shaft.h"

namespace penumbra::bench {

/// A scene reduced to what the workload needs.
struct BenchScene {
  /// The direction through pixel (px,py) is forward + (2px/width-1) right + (1-2py/height) up.
  struct Camera {
    Vec3f origin, right, up, forward;
    int width = 0, height = 0;
  };
  struct Quad {
    Vec3f o, u, v;
    PrimitiveId id;
    uint32_t primitives = 0;

    LightPolygon polygon() const { return LightPolygon::quad(o, u, v, id, primitives); }
  };
  std::vector<TriangleMesh> meshes;
  std::vector<ObjectInput> objects;
  std::vector<InstanceInput> instances;
  std::vector<Quad> lights;
  Camera camera;

  std::vector<MeshInput> inputs() const;
};

/// One shading point: lines towards one light and a point on each of them.
struct ShadingPoint {
  std::vector<LineQuery> lines;
  std::vector<LightEnd> points;  ///< one on each line
  Vec3f normal{0};               ///< of the surface, on the side of x
  size_t light = 0;              ///< into BenchScene::lights
};

/// Camera hits in 16×16 tiles drawn at random, pixel by pixel within a tile, each with `lines` random chords
/// (parallel to either edge) of a random light that the hit faces, clipped to its horizon.
std::vector<ShadingPoint> tile_coherent_points(const Geometry& geometry, const BenchScene& scene,
                                               size_t count, int lines, uint32_t seed);

}  // namespace penumbra::bench

#pragma once
// A scene ready to be rendered: immutable, shared by a worker's threads. Made by scene_builder.cpp.
#include <memory>
#include <optional>
#include <vector>

#include "proto/job.h"
#include "scenes/mesh.h"
#include "worker/effects/effects.h"
#include "worker/geometry/geometry.h"
#include "worker/materials/material.h"
#include "worker/render/filter.h"
#include "worker/render/renderer.h"
#include "worker/strategies/light_set.h"
#include "worker/textures/textures.h"

namespace penumbra {

/// A mesh and what shading must know of it.
struct SceneMesh {
  TriangleMesh mesh;  ///< world space, or object space if an object owns it
  int material = -1;
  /// The normal from the vertices' order points against pbrt's orientation (ReverseOrientation, or a
  /// transform that swaps handedness). Vertex normals in the mesh are already turned.
  bool flip = false;
  std::unique_ptr<const Tubes> tubes;  ///< then there are no triangles
};

struct SceneInstance {
  Matrix to_world;      ///< at time 0
  Imath::M33d normals;  ///< inverse transpose of the linear part, for row vectors
  bool swaps_handedness = false;
  std::shared_ptr<const AnimatedTransform> motion;  ///< null: it stands
};

class Scene {
 public:
  SceneDescription description;  ///< without shapes: camera, film and sampler settings are read per job
  std::vector<SceneMesh> meshes;
  std::vector<SceneInstance> instances;
  std::optional<Geometry> geometry;
  Textures textures;
  Materials materials;
  LightSet lights;
  Effects effects;
  std::optional<Filter> filter;
  bool footprints = false;  ///< some texture or bump map wants pixel footprints
  int64_t triangles = 0;    ///< instances counted as often as they are placed
};

}  // namespace penumbra

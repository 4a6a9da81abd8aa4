#pragma once
// From the description to the scene: meshes placed, lights found, everything built.
#include "absl/status/statusor.h"
#include "worker/render/scene.h"
#include "worker/render/tube_placer.h"

namespace penumbra {

/// The steps of build_scene(), in order.
class RenderSceneBuilder {
 public:
  /// Shapes and instances of the description that have two placements move.
  RenderSceneBuilder(const SceneDescription& description, Effects effects, const SceneFiles& files,
                     const LoadOptions& options, std::vector<std::string>& warnings)
      : description_(description),
        effects_(std::move(effects)),
        files_(files),
        options_(options),
        warnings_(warnings),
        tubes_(description, files, scene_, warnings) {}

  absl::StatusOr<ScenePtr> build();

 private:
  absl::Status place_shapes();
  absl::Status place_objects();
  /// Who owns a mesh: the world, the object of a shape that moves, an object of the text.
  enum class Owner { kWorld, kMover, kObject };
  /// `to_parent`: to the owner's space.
  absl::Status place_shape(const ShapeEntity& shape, const Matrix& to_parent, Owner owner);
  absl::Status place_object(uint32_t object, const Placement& placement, FileLoc loc);
  absl::Status build_textures();
  absl::Status build_geometry();
  absl::Status add_lights();
  AlphaTest alpha_test(size_t mesh) const;

  const SceneDescription& description_;
  Effects effects_;
  const SceneFiles& files_;
  const LoadOptions& options_;
  std::vector<std::string>& warnings_;
  ScenePtr scene_;
  std::vector<const ShapeEntity*> shapes_;  ///< per mesh: what it was made from
  std::vector<bool> visible_;               ///< per mesh
  std::vector<FloatValue> alpha_;           ///< per mesh; constant 1: opaque
  std::vector<bool> used_textures_;
  std::vector<ObjectInput> objects_;
  std::vector<InstanceInput> placed_;
  TubePlacer tubes_;
};

/// Area emitters of a placed shape, appended to `lights`; the mesh's triangles are its surface. One that moves
/// is in its object's space, and `instance` will carry it. (area_lights.cpp)
absl::Status add_area_light(const ShapeEntity& shape, uint32_t mesh, uint32_t instance, const SceneMesh& placed,
                            bool visible, const SceneDescription& description, const SceneFiles& files,
                            LightSet& lights, std::vector<std::string>& warnings);

/// Lights that are not on shapes: point, spot, distant, infinite. (distant_lights.cpp)
absl::Status add_light(const LightEntity& light, const SceneDescription& description, const SceneFiles& files,
                       bool strict, LightSet& lights, std::vector<std::string>& warnings);

/// Applies an object-to-world transform to a mesh; vertex normals come out unit and turned if `reverse`.
void transform(TriangleMesh& mesh, const Matrix& to_world, bool reverse);
bool swaps_handedness(const Matrix& m);

}  // namespace penumbra

#include "worker/render/scene_builder.h"

#include <algorithm>
#include <cmath>

#include "proto/status.h"

namespace penumbra {

bool swaps_handedness(const Matrix& m) {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
         0;
}

namespace {

Imath::M33d normal_matrix(const Matrix& m) {
  Imath::M33d linear;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) linear[i][j] = m[i][j];
  return linear.gjInverse().transposed();
}

}  // namespace

void transform(TriangleMesh& mesh, const Matrix& to_world, bool reverse) {
  if (to_world != Matrix()) {
    for (Vec3f& p : mesh.positions) {
      Vec3d out;
      to_world.multVecMatrix(Vec3d(p), out);
      p = Vec3f(out);
    }
    const Imath::M33d normals = normal_matrix(to_world);
    for (Vec3f& n : mesh.normals) n = Vec3f((Vec3d(n) * normals).normalized());
    for (Vec3f& t : mesh.tangents) {
      Vec3d out;
      to_world.multDirMatrix(Vec3d(t), out);
      t = Vec3f(out);
    }
  }
  if (reverse)
    for (Vec3f& n : mesh.normals) n = -n;
}

absl::StatusOr<ScenePtr> RenderSceneBuilder::build() {
  scene_.reset(new Scene);
  scene_->description.files = description_.files;
  scene_->description.camera = description_.camera;
  scene_->description.camera_placement = description_.camera_placement;
  scene_->description.materials = description_.materials;
  scene_->effects = std::move(effects_);
  ASSIGN_OR_RETURN(scene_->materials, Materials::build(description_, files_, options_.strict, warnings_));
  ASSIGN_OR_RETURN(scene_->filter, Filter::build(description_, warnings_));
  used_textures_ = scene_->materials.used_textures();
  used_textures_.resize(description_.textures.size());
  RETURN_IF_ERROR(place_shapes());
  RETURN_IF_ERROR(place_objects());
  for (TubePlacer::Placed& placed : tubes_.finish()) {
    scene_->meshes.push_back(std::move(placed.mesh));
    shapes_.push_back(placed.shape);
    visible_.push_back(true);
    alpha_.push_back({1});
  }
  ASSIGN_OR_RETURN(scene_->effects.media, build_media(description_, files_, shapes_, options_.threads));
  RETURN_IF_ERROR(build_textures());
  RETURN_IF_ERROR(add_lights());
  RETURN_IF_ERROR(build_geometry());
  Vec3f lo, hi;
  scene_->geometry->bounds(lo, hi);
  if (lo.x <= hi.x)
    scene_->lights.finish((hi - lo).length(), lo * 0.5f + hi * 0.5f);
  else
    scene_->lights.finish(1, Vec3f(0));
  return std::move(scene_);
}

/// As in pbrt a shape that moves is an object of its own, placed by an instance that moves; neighbours of the
/// same motion are one object.
absl::Status RenderSceneBuilder::place_shapes() {
  const std::vector<ShapeEntity>& shapes = description_.shapes;
  const auto together = [](const Placement& a, const Placement& b) {
    return a.start == b.start && a.end == b.end;
  };
  for (size_t i = 0; i < shapes.size();) {
    const Placement& placement = shapes[i].placement;
    if (!placement.moving()) {
      RETURN_IF_ERROR(place_shape(shapes[i], placement.start, Owner::kWorld));
      ++i;
      continue;
    }
    const uint32_t first = uint32_t(scene_->meshes.size());
    const FileLoc loc = shapes[i].loc;
    for (; i < shapes.size() && together(shapes[i].placement, placement); ++i)
      RETURN_IF_ERROR(place_shape(shapes[i], Matrix(), Owner::kMover));
    objects_.push_back({first, uint32_t(scene_->meshes.size())});
    RETURN_IF_ERROR(place_object(uint32_t(objects_.size() - 1), placement, loc));
  }
  return absl::OkStatus();
}

absl::Status RenderSceneBuilder::place_shape(const ShapeEntity& shape, const Matrix& to_parent,
                                             Owner owner) {
  if (has_tubes(shape)) return owner != Owner::kWorld ? absl::OkStatus() : tubes_.add(shape, to_parent);
  if (!has_mesh(shape)) return absl::OkStatus();  // named by unsupported()
  ASSIGN_OR_RETURN(TriangleMesh mesh, make_mesh(shape, description_, files_, warnings_));
  if (mesh.indices.empty()) return absl::OkStatus();
  SceneMesh placed;
  placed.material = shape.material;
  placed.flip = shape.reverse_orientation != swaps_handedness(to_parent);
  transform(mesh, to_parent, shape.reverse_orientation);
  placed.mesh = std::move(mesh);

  FloatValue alpha = float_value(shape.params, "alpha", 1);
  if (alpha.texture >= 0) used_textures_[size_t(alpha.texture)] = true;
  const bool emits = shape.area_light >= 0;
  bool visible = alpha.texture >= 0 || alpha.constant > 0;
  if (!emits && scene_->materials.is_interface(shape.material)) visible = false;
  if (!emits && !visible) return absl::OkStatus();
  if (emits && owner == Owner::kObject) {
    warnings_.push_back(fmt::format("{}: an area light inside an object does not emit (as in pbrt)",
                                    description_.place(shape.loc)));
  } else if (emits) {
    // The object of a mover is placed once, next.
    const uint32_t instance = owner == Owner::kMover ? uint32_t(placed_.size()) : kNone;
    RETURN_IF_ERROR(add_area_light(shape, uint32_t(scene_->meshes.size()), instance, placed, visible,
                                   description_, files_, scene_->lights, warnings_));
  }
  if (owner == Owner::kWorld) scene_->triangles += int64_t(placed.mesh.triangles());
  scene_->meshes.push_back(std::move(placed));
  shapes_.push_back(&shape);
  visible_.push_back(visible);
  alpha_.push_back(alpha);
  return absl::OkStatus();
}

/// Objects that are placed at least once, each one's meshes side by side, and their instances.
absl::Status RenderSceneBuilder::place_objects() {
  std::vector<uint32_t> object_of(description_.objects.size(), kNone);
  for (const InstanceEntity& instance : description_.instances) {
    if (instance.object < 0) continue;
    const ObjectEntity& entity = description_.objects[size_t(instance.object)];
    uint32_t& object = object_of[size_t(instance.object)];
    if (object == kNone) {
      const uint32_t first = uint32_t(scene_->meshes.size());
      for (const ShapeEntity& shape : entity.shapes)
        RETURN_IF_ERROR(place_shape(shape, shape.placement.start, Owner::kObject));
      object = uint32_t(objects_.size());
      objects_.push_back({first, uint32_t(scene_->meshes.size())});
    }
    for (const ShapeEntity& shape : entity.shapes)
      if (has_tubes(shape))
        RETURN_IF_ERROR(tubes_.add(shape, shape.placement.start * instance.placement.start));
    RETURN_IF_ERROR(place_object(object, instance.placement, instance.loc));
  }
  return absl::OkStatus();
}

absl::Status RenderSceneBuilder::place_object(uint32_t object, const Placement& placement, FileLoc loc) {
  if (objects_[object].first_mesh == objects_[object].last_mesh) return absl::OkStatus();
  std::shared_ptr<const AnimatedTransform> motion;
  Matrix to_world = placement.start;
  if (placement.moving()) {
    const auto moves = AnimatedTransform::between(placement.start, placement.end, shutter_of(description_));
    PENUMBRA_CHECK(moves);  // standing() has refused what cannot move
    motion = std::make_shared<const AnimatedTransform>(*moves);
    to_world = motion->at(0);
  }
  if (to_world.determinant() == 0)
    return invalid_input("{}: the instance's transform is singular", description_.place(loc));
  placed_.push_back({object, to_world, motion});
  scene_->instances.push_back({to_world, normal_matrix(to_world), swaps_handedness(to_world), motion});
  for (uint32_t m = objects_[object].first_mesh; m < objects_[object].last_mesh; ++m)
    scene_->triangles += int64_t(scene_->meshes[m].mesh.triangles());
  return absl::OkStatus();
}

absl::Status RenderSceneBuilder::build_textures() {
  ASSIGN_OR_RETURN(scene_->textures,
                   Textures::build(description_, files_, used_textures_, options_.strict, warnings_));
  scene_->footprints = std::find(used_textures_.begin(), used_textures_.end(), true) != used_textures_.end();
  return absl::OkStatus();
}

AlphaTest RenderSceneBuilder::alpha_test(size_t mesh) const {
  const FloatValue alpha = alpha_[mesh];
  if (alpha.texture < 0) return {};
  const TriangleMesh* triangles = &scene_->meshes[mesh].mesh;
  const Textures* textures = &scene_->textures;
  // As pbrt-v3: a hit counts unless the texture is exactly 0 there.
  return [=](uint32_t primitive, float u, float v) {
    const uint32_t* index = &triangles->indices[size_t(primitive) * 3];
    const float b0 = 1 - u - v;
    const Vec3f p = triangles->positions[index[0]] * b0 + triangles->positions[index[1]] * u +
                    triangles->positions[index[2]] * v;
    Vec2f uv(u + v, v);
    if (!triangles->uvs.empty())
      uv = triangles->uvs[index[0]] * b0 + triangles->uvs[index[1]] * u + triangles->uvs[index[2]] * v;
    return textures->evaluate(alpha, uv, p) != 0;
  };
}

absl::Status RenderSceneBuilder::build_geometry() {
  std::vector<MeshInput> inputs;
  inputs.reserve(scene_->meshes.size());
  for (size_t m = 0; m < scene_->meshes.size(); ++m)
    inputs.push_back({&scene_->meshes[m].mesh, alpha_test(m), visible_[m], scene_->meshes[m].tubes.get()});
  ASSIGN_OR_RETURN(scene_->geometry, Geometry::build(inputs, objects_, placed_, options_.threads));
  for (AreaEmitter& light : scene_->lights.area) {
    light.has_holes = light.flat && alpha_[light.mesh].texture >= 0;
    if (!light.flat || light.motion) continue;
    const PrimitiveId id{kNone, light.mesh, light.first_primitive};
    const LightPlace place =
        scene_->geometry->place_of(id, light.primitives, emission_normal(light.shape, Vec3d(0)));
    light.rounding = place.rounding;
    light.crowded = place.crowded;
  }
  return absl::OkStatus();
}

absl::Status RenderSceneBuilder::add_lights() {
  for (const LightEntity& light : description_.lights)
    RETURN_IF_ERROR(add_light(light, description_, files_, options_.strict, scene_->lights, warnings_));
  scene_->lights.by_mesh.resize(scene_->meshes.size());
  return absl::OkStatus();
}

}  // namespace penumbra

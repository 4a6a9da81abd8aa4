#include "tests/bench/geometry/bench_scene.h"

#include <cmath>
#include <filesystem>
#include <numbers>

#include "proto/status.h"
#include "scenes/film_size.h"
#include "scenes/mesh.h"
#include "scenes/parser.h"

namespace penumbra::bench {
namespace {

class Loader {
 public:
  Loader(const SceneDescription& description, const std::string& path)
      : description_(description), files_(std::filesystem::path(path).parent_path().string()) {}

  absl::StatusOr<BenchScene> load() {
    place_camera();
    for (const ShapeEntity& shape : description_.shapes) RETURN_IF_ERROR(add(shape, false));
    for (const ObjectEntity& object : description_.objects) {
      const auto first = static_cast<uint32_t>(scene_.meshes.size());
      for (const ShapeEntity& shape : object.shapes) RETURN_IF_ERROR(add(shape, true));
      scene_.objects.push_back({first, static_cast<uint32_t>(scene_.meshes.size())});
    }
    for (const InstanceEntity& instance : description_.instances) {
      if (instance.object < 0) continue;
      scene_.instances.push_back({static_cast<uint32_t>(instance.object), instance.placement.start});
    }
    if (scene_.lights.empty()) return invalid_input("the scene has no quad light to draw lines on");
    return std::move(scene_);
  }

 private:
  absl::Status add(const ShapeEntity& shape, bool in_object) {
    if (!has_mesh(shape)) return absl::OkStatus();
    std::vector<std::string> warnings;
    ASSIGN_OR_RETURN(TriangleMesh mesh, make_mesh(shape, description_, files_, warnings));
    for (Vec3f& p : mesh.positions) {
      Vec3d world;
      shape.placement.start.multVecMatrix(Vec3d(p), world);
      p = Vec3f(world);
    }
    const auto index = static_cast<uint32_t>(scene_.meshes.size());
    if (!in_object && shape.area_light >= 0 && shape.type == "quad") {
      const Vec3f o = mesh.positions[0];
      BenchScene::Quad light{o, mesh.positions[1] - o, mesh.positions[3] - o, {kNone, index, 0}, 2};
      // Emission turns over with the orientation and with transforms that swap handedness; u × v has
      // turned with the transform already.
      if (shape.reverse_orientation) std::swap(light.u, light.v);
      scene_.lights.push_back(light);
    }
    scene_.meshes.push_back(std::move(mesh));
    return absl::OkStatus();
  }

  void place_camera() {
    auto& camera = scene_.camera;
    const FilmSize film = film_size(description_.film);
    camera.width = static_cast<int>(film.width);
    camera.height = static_cast<int>(film.height);
    const Matrix to_world = description_.camera_placement.start.inverse();
    const auto direction = [&](double x, double y, double z) {
      Vec3d d;
      to_world.multDirMatrix(Vec3d(x, y, z), d);
      return Vec3f(d);
    };
    // pbrt: the field of view spans the shorter side.
    const double half = std::tan(description_.camera.params.number("fov", 90) * std::numbers::pi / 360);
    const double shorter = std::min(camera.width, camera.height);
    camera.right = direction(half * camera.width / shorter, 0, 0);
    camera.up = direction(0, half * camera.height / shorter, 0);
    camera.forward = direction(0, 0, 1);
    Vec3d origin;
    to_world.multVecMatrix(Vec3d(0, 0, 0), origin);
    camera.origin = Vec3f(origin);
  }

  const SceneDescription& description_;
  FolderFiles files_;
  BenchScene scene_;
};

}  // namespace

absl::StatusOr<BenchScene> load_bench_scene(const std::string& path) {
  ASSIGN_OR_RETURN(const SceneDescription description, parse_scene_file(path));
  return Loader(description, path).load();
}

}  // namespace penumbra::bench

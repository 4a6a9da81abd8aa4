// Any bytes as a scene: parsed, checked, meshed. Every file that the scene names is the scene itself.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>

#include "proto/status.h"
#include "scenes/check.h"
#include "scenes/mesh.h"
#include "scenes/needs.h"
#include "scenes/parser.h"

namespace {

/// One file in memory under every name.
class MemoryFile final : public penumbra::SceneFiles {
 public:
  MemoryFile() : fd_(::memfd_create("scene", 0)) { PENUMBRA_CHECK(fd_ >= 0); }
  void write(const uint8_t* bytes, size_t count) const {
    PENUMBRA_CHECK(::ftruncate(fd_, 0) == 0);
    PENUMBRA_CHECK(::pwrite(fd_, bytes, count, 0) == static_cast<ssize_t>(count));
  }
  absl::StatusOr<std::string> path_of(std::string_view) const override {
    return fmt::format("/proc/self/fd/{}", fd_);
  }

 private:
  int fd_;
};

/// So many levels make millions of triangles of one, which tells no more than a few do. More still are
/// refused.
bool takes_minutes(const penumbra::ShapeEntity& shape) {
  constexpr int64_t kFew = 4, kRefused = 14;
  const int64_t levels = shape.params.integer("levels", shape.params.integer("nlevels", 3));
  return shape.type == "loopsubdiv" && levels > kFew && levels < kRefused;
}

bool takes_minutes(const penumbra::SceneDescription& scene) {
  const auto any = [](const std::vector<penumbra::ShapeEntity>& shapes) {
    return std::any_of(shapes.begin(), shapes.end(),
                       [](const penumbra::ShapeEntity& shape) { return takes_minutes(shape); });
  };
  return any(scene.shapes) ||
         std::any_of(scene.objects.begin(), scene.objects.end(),
                     [&](const penumbra::ObjectEntity& object) { return any(object.shapes); });
}

/// Grids of some thousand points, alike but for a factor: they took three quarters of the time. Those of one
/// input in eight are made.
bool is_passed_over(const penumbra::ShapeEntity& shape, const uint8_t* bytes, size_t count) {
  if (shape.type != "sphere" && shape.type != "disk" && shape.type != "cylinder") return false;
  uint32_t hash = 2166136261u;  // FNV-1a
  for (size_t i = 0; i < count; ++i) hash = (hash ^ bytes[i]) * 16777619u;
  return hash % 8 != 0;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
  static const MemoryFile file;
  file.write(bytes, count);
  const auto scene = penumbra::parse_scene("scene", file);
  if (!scene.ok()) return 0;
  penumbra::needs_of(*scene);
  penumbra::unsupported(*scene);
  if (takes_minutes(*scene)) return 0;
  if (!penumbra::check_files(*scene, file).ok()) return 0;
  std::vector<std::string> warnings;
  for (const penumbra::ShapeEntity& shape : scene->shapes)
    if (penumbra::has_mesh(shape) && !is_passed_over(shape, bytes, count))
      static_cast<void>(penumbra::make_mesh(shape, *scene, file, warnings));
  return 0;
}

#include "scenes/check.h"

#include <string_view>
#include <unordered_set>

#include "scenes/curve.h"
#include "scenes/diagnostics.h"
#include "scenes/hair_params.h"
#include "scenes/mesh.h"
#include "scenes/ply.h"
#include "scenes/quadrics.h"

namespace penumbra {
namespace {

class Checker {
 public:
  Checker(const SceneDescription& description, const SceneFiles& files)
      : description_(description), files_(files) {}

  absl::Status check(const ShapeEntity& shape) {
    if (shape.type == "plymesh") return check_ply(shape);
    // Quadrics are checked without their meshes, which are large and cannot fail.
    if (shape.type == "sphere") return sphere_of(shape, description_).status();
    if (shape.type == "disk") return disk_of(shape, description_).status();
    if (shape.type == "cylinder") return cylinder_of(shape, description_).status();
    std::vector<std::string> warnings;  // the renderer gives them
    if (shape.type == "curve") return curve_of(shape, description_, files_, warnings).status();
    if (!has_mesh(shape)) return absl::OkStatus();
    return make_mesh(shape, description_, files_, warnings).status();
  }

 private:
  absl::Status check_ply(const ShapeEntity& shape) {
    const std::string name = shape.params.string("filename", "");
    if (!checked_.insert(name).second) return absl::OkStatus();
    const absl::StatusOr<std::string> path = files_.path_of(name);
    const absl::Status status = path.ok() ? check_ply_file(*path) : path.status();
    if (status.ok()) return status;
    return invalid_input("{}: plymesh '{}': {}", description_.place(shape.loc), printable(name),
                         message_of(status));
  }

  const SceneDescription& description_;
  const SceneFiles& files_;
  std::unordered_set<std::string> checked_;
};

}  // namespace

absl::Status check_files(const SceneDescription& description, const SceneFiles& files) {
  if (!description.has_world)
    return invalid_input("{}: no WorldBegin: there is nothing to render", description.files.front());
  for (const MaterialEntity& material : description.materials)
    RETURN_IF_ERROR(check_hair(material, description));
  Checker checker(description, files);
  for (const ShapeEntity& shape : description.shapes) RETURN_IF_ERROR(checker.check(shape));
  for (const ObjectEntity& object : description.objects)
    for (const ShapeEntity& shape : object.shapes) RETURN_IF_ERROR(checker.check(shape));
  return absl::OkStatus();
}

}  // namespace penumbra

#include "worker/effects/media.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "proto/status.h"
#include "scenes/curve.h"
#include "scenes/each_shape.h"
#include "scenes/mesh.h"

namespace penumbra {
namespace {

bool is_boundary(const ShapeEntity& shape, const SceneDescription& description) {
  if (shape.material < 0 || shape.area_light >= 0) return false;
  const std::string& type = description.materials[size_t(shape.material)].type;
  return type.empty() || type == "none" || type == "interface";
}

bool swaps(const Matrix& m) {
  Imath::M33d linear;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) linear[i][j] = m[i][j];
  return linear.determinant() < 0;
}

/// Does the order of the vertices go against the vertex normals, which decide the side where there are any?
bool winds_against_normals(const TriangleMesh& mesh) {
  if (mesh.normals.empty()) return false;
  double sum = 0;
  for (size_t t = 0; t < mesh.triangles(); ++t) {
    const uint32_t* i = &mesh.indices[3 * t];
    const Vec3d p0(mesh.positions[i[0]]), p1(mesh.positions[i[1]]), p2(mesh.positions[i[2]]);
    sum += (p1 - p0).cross(p2 - p0).dot(Vec3d(mesh.normals[i[0]] + mesh.normals[i[1]] + mesh.normals[i[2]]));
  }
  return sum < 0;
}

/// Names to indices, and what is collected on the way.
class Builder {
 public:
  Builder(const SceneDescription& description, const SceneFiles& files)
      : description_(description), files_(files) {}

  absl::Status read_media(std::vector<Medium>& media) {
    for (const MediumEntity& entity : description_.media) {
      ASSIGN_OR_RETURN(const std::unique_ptr<Medium> medium, build_medium(entity, description_, files_));
      index_[entity.name] = medium ? int(media.size()) : -1;  // the last of a name wins
      if (medium) media.push_back(std::move(*medium));
    }
    return absl::OkStatus();
  }

  /// A name that no medium has is vacuum; unsupported() says so.
  int index(const std::string& name) const {
    const auto found = index_.find(name);
    return found != index_.end() ? found->second : -1;
  }

  MediumSides sides(const ShapeEntity& shape) {
    return {index(shape.inside_medium), index(shape.outside_medium)};
  }

  /// A shape that rays pass, where it parts two media.
  absl::Status add_boundary(const ShapeEntity& shape, const Matrix& to_world) {
    const MediumSides both = sides(shape);
    if (!is_boundary(shape, description_) || !both.differ() || !has_mesh(shape)) return absl::OkStatus();
    std::vector<std::string> said_before;  // the scene's builder has made this mesh, too
    ASSIGN_OR_RETURN(TriangleMesh mesh, make_mesh(shape, description_, files_, said_before));
    if (mesh.indices.empty()) return absl::OkStatus();
    bool flip = shape.reverse_orientation != swaps(to_world);
    if (winds_against_normals(mesh)) flip = !flip;
    for (Vec3f& p : mesh.positions) {
      Vec3d out;
      to_world.multVecMatrix(Vec3d(p), out);
      p = Vec3f(out);
    }
    meshes.push_back(std::move(mesh));
    boundaries.push_back(flip ? MediumSides{both.outside, both.inside} : both);
    return absl::OkStatus();
  }

  std::vector<TriangleMesh> meshes;
  std::vector<MediumSides> boundaries;

 private:
  const SceneDescription& description_;
  const SceneFiles& files_;
  std::map<std::string, int> index_;
};

}  // namespace

absl::StatusOr<Media> Media::build(const SceneDescription& description, const SceneFiles& files,
                                   std::span<const ShapeEntity* const> shapes, int threads) {
  Media media;
  Builder builder(description, files);
  RETURN_IF_ERROR(builder.read_media(media.media_));
  media.at_camera_ = builder.index(description.camera_medium);
  for (const ShapeEntity* shape : shapes) {
    MediumSides sides = builder.sides(*shape);
    // A tube is opaque to what leaves it, light goes on from its other side: no ray is ever inside.
    if (has_tubes(*shape)) sides.inside = sides.outside;
    media.surfaces_.push_back(sides);
  }
  for (const ShapeEntity& shape : description.shapes)
    RETURN_IF_ERROR(builder.add_boundary(shape, shape.placement.start));
  for (const InstanceEntity& instance : description.instances) {
    if (instance.object < 0) continue;
    for (const ShapeEntity& shape : description.objects[size_t(instance.object)].shapes)
      RETURN_IF_ERROR(builder.add_boundary(shape, shape.placement.start * instance.placement.start));
  }
  if (!builder.meshes.empty()) {
    ASSIGN_OR_RETURN(CrossingScene crossings, CrossingScene::build(builder.meshes, threads));
    media.crossings_ = std::move(crossings);
  }
  media.boundaries_ = std::move(builder.boundaries);
  return media;
}

int Media::beyond(std::span<const Crossing> touching, int medium) const {
  // An edge between two triangles may have counted twice: of each boundary one crossing per direction.
  constexpr size_t kMost = 16;
  std::array<Crossing, kMost> left;
  size_t n = 0;
  for (const Crossing& c : touching) {
    const auto same = [&c](const Crossing& o) { return o.mesh == c.mesh && o.from_front == c.from_front; };
    if (n < kMost && std::none_of(left.begin(), left.begin() + std::ptrdiff_t(n), same)) left[n++] = c;
  }
  for (; n > 0; --n) {
    // They come in any order: first one that begins where the way is, as the next room's wall does.
    size_t next = 0;
    for (size_t i = n; i-- > 0;)
      if (before(left[i]) == medium) next = i;
    medium = after(left[next]);
    std::copy(left.begin() + std::ptrdiff_t(next) + 1, left.begin() + std::ptrdiff_t(n),
              left.begin() + std::ptrdiff_t(next));
  }
  return medium;
}

int Media::pieces(const Way& way, std::vector<Crossing>& crossings, std::vector<MediumPiece>& out) const {
  out.clear();
  crossings.clear();
  int medium = way.medium;
  double t = 0;
  const auto go_to = [&](double end) {
    if (medium >= 0 && end > t) out.push_back({medium, t, end});
    t = std::max(t, end);
  };
  if (crossings_) crossings_->crossings({way.origin, way.direction, 0, float(way.distance)}, crossings);
  // Two surfaces touch if they are no farther apart, along the boundary's normal, than both distances are
  // rounded: some units of the last place (2⁻²³) of the largest length in them, taken 32 times.
  const float largest = std::max({std::abs(way.origin.x), std::abs(way.origin.y), std::abs(way.origin.z)});
  const auto touch = [&](const Crossing& c, double at) {
    return std::abs(c.distance - at) * c.cosine <= 0x1p-18 * (largest + c.distance);
  };
  for (size_t first = 0, last = 0; first < crossings.size(); first = last) {
    for (last = first + 1; last < crossings.size() && touch(crossings[last], crossings[last - 1].distance);)
      ++last;
    if (way.from_surface && touch(crossings[first], 0)) continue;
    if (way.to_surface && touch(crossings[last - 1], way.distance)) continue;
    go_to(crossings[first].distance);
    medium = beyond({crossings.data() + first, last - first}, medium);
  }
  go_to(way.distance);
  return medium;
}

}  // namespace penumbra

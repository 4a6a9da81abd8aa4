#include "worker/effects/environment.h"

#include <cmath>
#include <mutex>
#include <numbers>

#include "proto/status.h"
#include "scenes/similarity.h"
#include "scenes/substitutes.h"
#include "worker/effects/environment_map.h"
#include "worker/sampling/warp.h"
#include "worker/textures/textures.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

Imath::M33f linear_part(const Matrix& m) {
  Imath::M33f r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r[i][j] = float(m[i][j]);
  return r;
}

}  // namespace

struct Environment::Arcs {
  std::once_flag made;
  std::optional<ArcTable> table;
};

absl::StatusOr<Environment> Environment::build(const LightEntity& light, const SceneDescription& description,
                                               const SceneFiles& files, bool strict,
                                               std::vector<std::string>& warnings) {
  Environment e;
  const std::string at = description.place(light.loc);
  e.to_world_ = linear_part(light.placement.start);
  e.to_light_ = linear_part(light.placement.start.inverse());
  if (const Param* radiance = light.params.find("L")) {
    ASSIGN_OR_RETURN(e.scale_, to_rgb(*radiance, description, files));
  }
  if (const Param* scale = light.params.find("scale")) {
    if (scale->numbers.size() >= 3)
      e.scale_ *= Rgb(float(scale->numbers[0]), float(scale->numbers[1]), float(scale->numbers[2]));
    else
      e.scale_ *= float(light.params.number("scale", 1));
  }
  if (const Param* portal = light.params.find("portal")) {
    ASSIGN_OR_RETURN(e.portal_, Portal::build(*portal, description));
  }
  const bool v4 = light.params.find("filename") != nullptr;
  const std::string name = light.params.string(v4 ? "filename" : "mapname", "");
  if (name.empty()) return e;
  auto path = files.path_of(name);
  if (!path.ok()) {
    const std::string what = missing_text(light, name, description);
    if (strict) return absl::InvalidArgumentError(what);
    warnings.push_back(what);
    return e;
  }
  if (double scale = 1; !is_similarity(light.placement.start, scale)) {
    const Imath::M33d linear(e.to_world_);
    e.volume_ = std::abs(linear.determinant());
    if (!(e.volume_ > 0)) return invalid_input("{}: the environment map's transform is singular", at);
  }
  auto map = std::make_shared<EnvironmentMap>();
  if (absl::Status s = map->read(*path, v4); !s.ok())
    return invalid_input("{}: environment map '{}': {}", at, name, message_of(s));
  if (map->total() > 0)
    e.use(std::move(map));
  else
    e.scale_ = Rgb(0);
  return e;
}

void Environment::use(std::shared_ptr<const EnvironmentMap> map) {
  map_ = std::move(map);
  arcs_ = std::make_shared<Arcs>();
  if (!portal_) return;
  const auto with_table = std::make_shared<Portal>(*portal_);
  with_table->set_table(map_->seen_through(portal_->axes() * Imath::M33d(to_light_)));
  portal_ = with_table;
}

Rgb Environment::radiance(const Vec3d& x, const Vec3f& direction) const {
  return portal_ && !portal_->passes(x, Vec3d(direction)) ? Rgb(0) : radiance(direction);
}

Rgb Environment::radiance(const Vec3f& direction) const {
  if (!map_) return scale_;
  int x = 0, y = 0;
  const Vec3f local = direction * to_light_;
  map_->texel_of(Vec3d(local).normalized(), x, y);
  return map_->texel(x, y) * scale_;
}

EnvironmentSample Environment::sample(const Vec2d& u) const {
  EnvironmentSample s;
  if (!map_) {
    s.wi = Vec3f(square_to_sphere(u));
    s.radiance = scale_;
    s.pdf = 1 / (4 * kPi);
    return s;
  }
  int x = 0, y = 0;
  const Vec3d local = map_->sample(u, x, y);
  const Vec3f world = Vec3f(local) * to_world_;
  s.wi = world.normalized();
  s.radiance = map_->texel(x, y) * scale_;
  s.pdf = luminance_of(map_->texel(x, y)) / map_->total() * density_in_world(double{world.length()});
  return s;
}

double Environment::pdf(const Vec3f& direction) const {
  if (!map_) return 1 / (4 * kPi);
  int x = 0, y = 0;
  const Vec3f local = direction * to_light_;
  map_->texel_of(Vec3d(local).normalized(), x, y);
  const double density = luminance_of(map_->texel(x, y)) / map_->total();
  return volume_ == 0 ? density : density * density_in_world(1 / Vec3d(local).length());
}

/// A thin cone from the origin to w has the volume dω / 3. Its image is |M w| long and |det M| times as
/// large, so its solid angle is |det M| dω / |M w|³.
double Environment::density_in_world(double length) const {
  return volume_ == 0 ? 1 : length * length * length / volume_;
}

const ArcTable& Environment::arcs() const {
  static const ArcTable constant(1, 1, {1.0});
  if (!map_) return constant;
  std::call_once(arcs_->made, [this] { arcs_->table.emplace(map_->meridians()); });
  return *arcs_->table;
}

Rgb Environment::radiance(int column, int row, const Vec3f& direction) const {
  return map_ && !map_->equal_area() ? map_->texel(column, row) * scale_ : radiance(direction);
}

double Environment::mean_luminance() const {
  return luminance_of(scale_) * (map_ ? map_->total() / (4 * kPi) : 1);
}

double Environment::irradiance(const Vec3d& x) const {
  const double solid_angle = portal_ ? SeenShape(portal_->shape(), x).solid_angle() : kPi;
  return mean_luminance() * std::min(solid_angle, kPi);
}

}  // namespace penumbra

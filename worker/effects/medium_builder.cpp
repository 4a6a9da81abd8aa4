// `MakeNamedMedium` of pbrt-v3 and v4 to a Medium.
#include <cmath>

#include "proto/status.h"
#include "worker/effects/medium.h"
#include "worker/textures/textures.h"

namespace penumbra {
namespace {

class MediumBuilder {
 public:
  MediumBuilder(const MediumEntity& entity, const SceneDescription& description, const SceneFiles& files)
      : entity_(entity), description_(description), files_(files) {}

  absl::StatusOr<std::unique_ptr<Medium>> build() {
    const bool grid = entity_.type == "heterogeneous" || entity_.type == "uniformgrid";
    if (!grid && entity_.type != "homogeneous") return nullptr;  // named by unsupported()
    auto medium = std::make_unique<Medium>();
    RETURN_IF_ERROR(coefficients(*medium));
    RETURN_IF_ERROR(asymmetry(*medium));
    if (grid) {
      ASSIGN_OR_RETURN(medium->density, density());
    }
    return medium;
  }

 private:
  std::string at() const { return description_.place(entity_.loc); }

  absl::Status coefficients(Medium& medium) {
    const Params& params = entity_.params;
    // pbrt's coefficients where none are given: v4's uniform grid has 1, every other medium a fruit juice's.
    const bool ones = entity_.type == "uniformgrid";
    Vec3d sigma_a = ones ? Vec3d(1) : Vec3d(.0011, .0024, .014),
          sigma_s = ones ? Vec3d(1) : Vec3d(2.55, 3.21, 3.77);
    RETURN_IF_ERROR(coefficient("sigma_a", sigma_a));
    RETURN_IF_ERROR(coefficient("sigma_s", sigma_s));
    const double scale = params.number("scale", 1);
    if (!(scale >= 0))
      return invalid_input("{}: scale {} of medium '{}' is below 0", at(), scale, entity_.name);
    medium.sigma_s = sigma_s * scale;
    medium.sigma_t = (sigma_a + sigma_s) * scale;
    return absl::OkStatus();
  }

  absl::Status coefficient(const char* name, Vec3d& value) {
    const Param* param = entity_.params.find(name);
    if (param == nullptr) return absl::OkStatus();
    if (param->type == "float" && !param->numbers.empty()) {
      value = Vec3d(param->numbers[0]);
    } else {
      ASSIGN_OR_RETURN(const Rgb rgb, to_rgb(*param, description_, files_));
      value = Vec3d(rgb.x, rgb.y, rgb.z);
    }
    for (int c = 0; c < 3; ++c)
      if (!(value[c] >= 0 && std::isfinite(value[c])))
        return invalid_input("{}: {} of medium '{}' is {}: it must be finite and not below 0",
                             description_.place(param->loc), name, entity_.name, value[c]);
    return absl::OkStatus();
  }

  absl::Status asymmetry(Medium& medium) {
    medium.phase.g = entity_.params.number("g", 0);
    if (std::abs(medium.phase.g) < 1) return absl::OkStatus();
    return invalid_input("{}: g {} of medium '{}' must lie between -1 and 1", at(), medium.phase.g,
                         entity_.name);
  }

  absl::StatusOr<Density> density() {
    const Params& params = entity_.params;
    const int64_t n[] = {params.integer("nx", 1), params.integer("ny", 1), params.integer("nz", 1)};
    // No axis longer than the file could give numbers for: the product cannot overflow.
    constexpr int64_t kLongest = int64_t{1} << 20;
    for (const int64_t i : n)
      if (i < 1 || i > kLongest)
        return invalid_input("{}: medium '{}' has a grid of {} x {} x {}", at(), entity_.name, n[0], n[1],
                             n[2]);
    const Param* given = params.find("density");
    const size_t values = given == nullptr ? 0 : given->numbers.size();
    if (values != size_t(n[0] * n[1] * n[2]))
      return invalid_input("{}: medium '{}' has {} densities for a grid of {} x {} x {}", at(), entity_.name,
                           values, n[0], n[1], n[2]);
    std::vector<float> density(given->numbers.begin(), given->numbers.end());
    for (const float d : density)
      if (!(d >= 0 && std::isfinite(d)))
        return invalid_input("{}: density {} of medium '{}' must be finite and not below 0",
                             description_.place(given->loc), d, entity_.name);
    ASSIGN_OR_RETURN(const Matrix to_unit, world_to_unit());
    return DensityGrid(int(n[0]), int(n[1]), int(n[2]), std::move(density), to_unit);
  }

  absl::StatusOr<Vec3d> corner(const char* name, const Vec3d& fallback) const {
    const Param* param = entity_.params.find(name);
    if (param == nullptr) return fallback;
    if (param->numbers.size() != 3)
      return invalid_input("{}: {} needs 3 numbers", description_.place(param->loc), name);
    return Vec3d(param->numbers[0], param->numbers[1], param->numbers[2]);
  }

  absl::StatusOr<Matrix> world_to_unit() const {
    ASSIGN_OR_RETURN(const Vec3d p0, corner("p0", Vec3d(0)));
    ASSIGN_OR_RETURN(const Vec3d p1, corner("p1", Vec3d(1)));
    Matrix stretch, shift;
    stretch.setScale(p1 - p0);
    shift.setTranslation(p0);
    const Matrix to_world = stretch * shift * entity_.placement.start;
    if (to_world.determinant() == 0)
      return invalid_input("{}: the box of medium '{}' has no volume", at(), entity_.name);
    return to_world.gjInverse();
  }

  const MediumEntity& entity_;
  const SceneDescription& description_;
  const SceneFiles& files_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Medium>> build_medium(const MediumEntity& entity,
                                                     const SceneDescription& description,
                                                     const SceneFiles& files) {
  return MediumBuilder(entity, description, files).build();
}

}  // namespace penumbra

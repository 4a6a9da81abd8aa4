#pragma once
// Image and procedural textures of a scene, evaluated at surface points.
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/files.h"
#include "worker/geometry/surface_point.h"

namespace penumbra {

/// A float or spectrum value that may vary over a surface. Constants cost no lookup.
template <class T>
struct Value {
  T constant{};
  int texture = -1;  ///< index into the scene's textures; -1: the constant
};
using FloatValue = Value<float>;
using RgbValue = Value<Rgb>;

/// All textures of a scene. Immutable after build; evaluation is const and thread-safe.
class Textures {
 public:
  /// Loads the textures of the description that `used` marks (index by index). A missing image is a
  /// warning and constant 1; with `strict` an error.
  static absl::StatusOr<Textures> build(const SceneDescription& description, const SceneFiles& files,
                                        const std::vector<bool>& used, bool strict,
                                        std::vector<std::string>& warnings);
  Textures();
  Textures(Textures&&) noexcept;
  Textures& operator=(Textures&&) noexcept;
  ~Textures();

  float evaluate(const FloatValue& value, const SurfacePoint& point) const;
  Rgb evaluate(const RgbValue& value, const SurfacePoint& point) const;
  /// At texture coordinates alone (alpha tests): no filtering footprint.
  float evaluate(const FloatValue& value, const Vec2f& uv, const Vec3f& p) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Parameter of a material, light or shape as a value: a number, a colour of any kind (rgb, xyz,
/// blackbody, spectrum), or a texture.
FloatValue float_value(const Params& params, std::string_view name, float fallback);
absl::StatusOr<RgbValue> rgb_value(const Params& params, std::string_view name, Rgb fallback,
                                   const SceneDescription& description, const SceneFiles& files);

/// Linear RGB of a parameter that is no texture: rgb, xyz, float, spectrum (wavelength/value pairs, .spd
/// file, or a name that pbrt knows), blackbody (v3: pairs of temperature and scale, the peak is the scale;
/// v4: one temperature, luminance 1). NotFound for a spectrum file that is missing, which pbrt-v3 warns of;
/// InvalidArgument for every other fault. Both are `file:line:column: …`.
absl::StatusOr<Rgb> to_rgb(const Param& param, const SceneDescription& description, const SceneFiles& files);

}  // namespace penumbra

#pragma once
// Materials of a scene: from the description's parameters to a Bsdf at a point.
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/files.h"
#include "worker/materials/bsdf.h"
#include "worker/textures/textures.h"

namespace penumbra {

class Materials {
 public:
  /// An unsupported material is the nearest supported one and a named warning; with `strict` an error.
  static absl::StatusOr<Materials> build(const SceneDescription& description, const SceneFiles& files,
                                         bool strict, std::vector<std::string>& warnings);
  Materials();
  Materials(Materials&&) noexcept;
  Materials& operator=(Materials&&) noexcept;
  ~Materials();

  /// Which textures the materials use (parallel to description.textures), textures of textures included.
  const std::vector<bool>& used_textures() const;

  /// The Bsdf at a point; material -1 is pbrt's default matte. Bump and normal maps change the frame.
  Bsdf shade(int material, const SurfacePoint& point, const Textures& textures) const;
  /// pbrt's "none"/"interface": the surface is not there.
  bool is_interface(int material) const;
  bool has_bump(int material) const;
  bool has_specular(int material) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace penumbra

#pragma once
// The media of a scene and what bounds them: which medium is where along a ray.
#include <optional>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/description.h"
#include "scenes/files.h"
#include "worker/effects/medium.h"
#include "worker/geometry/crossings.h"

namespace penumbra {

/// Media on the sides of a surface, as indices; -1: vacuum. Outside is where the normal points to.
struct MediumSides {
  int inside = -1, outside = -1;
  bool differ() const { return inside != outside; }
};

/// A part of a ray in one medium that is not vacuum.
struct MediumPiece {
  int medium = 0;
  double t0 = 0, t1 = 0;
};

/// Immutable, shared by threads.
class Media {
 public:
  /// `shapes`: one per mesh of the scene. A name that no MakeNamedMedium gives is vacuum.
  static absl::StatusOr<Media> build(const SceneDescription& description, const SceneFiles& files,
                                     std::span<const ShapeEntity* const> shapes, int threads);

  int size() const { return int(media_.size()); }
  const Medium& medium(int index) const { return media_[size_t(index)]; }
  int at_camera() const { return at_camera_; }
  /// Of a mesh of the scene that light does not pass unseen; equal where the scene says nothing of it.
  const MediumSides& sides(uint32_t mesh) const { return surfaces_[mesh]; }

  /// A way along a ray with unit direction. Where it begins or ends on a surface, boundaries that touch that
  /// surface are not crossed.
  struct Way {
    Vec3f origin, direction;
    double distance = 0;  ///< may be infinite
    int medium = -1;      ///< where it begins
    bool from_surface = false, to_surface = false;
  };
  /// The pieces in order; returns the medium at the end.
  int pieces(const Way& way, std::vector<Crossing>& crossings, std::vector<MediumPiece>& out) const;

 private:
  int before(const Crossing& c) const {
    return c.from_front ? boundaries_[c.mesh].outside : boundaries_[c.mesh].inside;
  }
  int after(const Crossing& c) const {
    return c.from_front ? boundaries_[c.mesh].inside : boundaries_[c.mesh].outside;
  }
  /// The medium past boundaries that touch each other.
  int beyond(std::span<const Crossing> touching, int medium) const;

  std::vector<Medium> media_;
  std::vector<MediumSides> surfaces_;    ///< per mesh of the scene
  std::vector<MediumSides> boundaries_;  ///< per mesh of crossings_, for the side its vertices go round
  std::optional<CrossingScene> crossings_;
  int at_camera_ = -1;
};

}  // namespace penumbra

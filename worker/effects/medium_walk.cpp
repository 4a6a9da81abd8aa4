// The stage of render/medium_stage.h: single scattering and transmittance along paths and shadow segments.
#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/status.h"
#include "scenes/needs.h"
#include "worker/effects/effects.h"
#include "worker/effects/media.h"
#include "worker/render/medium_stage.h"

namespace penumbra {
namespace {

/// A path's own numbers are branches by few rays (PassSampler::branch): those of scatter points lie far off.
constexpr int kScatterBranch = 1 << 20;
/// PassSampler::select at a scatter point: how far along the ray, by which channel.
constexpr int kDistance = 0, kChannel = 1;

Rgb to_rgb(const Vec3d& v) {
  return Rgb(float(v.x), float(v.y), float(v.z));
}

/// A medium's phase function where a BSDF would be.
class PhaseScattering final : public Scattering {
 public:
  explicit PhaseScattering(const HenyeyGreenstein& hg) : hg_(hg) {}
  Rgb scatter(const Vec3f& wo, const Vec3f& wi) const override { return Rgb(float(phase(hg_, wo, wi))); }
  double pdf(const Vec3f& wo, const Vec3f& wi) const override { return phase(hg_, wo, wi); }
  std::optional<BsdfSample> sample(const Vec3f& wo, const Vec2d& u, double) const override {
    const Vec3f wi = penumbra::sample(hg_, wo, u);
    const double p = phase(hg_, wo, wi);
    return BsdfSample{wi, Rgb(float(p)), p};
  }
  /// At its peak the phase function is (1+|g|)/(1-|g|)² times the isotropic one.
  bool has_narrow_lobe() const override {
    const double g = std::abs(hg_.g);
    return 1 + g > kNarrowPeak * (1 - g) * (1 - g);
  }

 private:
  HenyeyGreenstein hg_;
};

/// What threads share.
struct Shared {
  Media media;
  std::vector<PhaseScattering> phases;  ///< per medium
};

class Walk final : public MediumWalk {
 public:
  explicit Walk(std::shared_ptr<const Shared> shared) : shared_(std::move(shared)) { start(); }

  void start() override { stand_in(shared_->media.at_camera()); }
  Rgb pass(const Ray& ray, double distance, const ScatterDraw* draw,
           std::vector<ScatterVertex>& out) override;
  void arrive() override { stand_in(end_); }
  std::span<const MediumPart> parts() const override { return parts_; }
  Rgb scattering(size_t part, double t) const override;
  void stand_in(int medium) override {
    here_ = outside_ = inside_ = medium;
    normal_ = Vec3f(0);
    on_surface_ = false;
  }
  void stand_on(uint32_t mesh, const Vec3f& ng) override;
  void leave(const Vec3f& direction) override {
    here_ = medium_towards(direction);
    on_surface_ = true;
  }
  Rgb transmittance(const Vec3f& x, const Vec3f& wi, double distance) const override;

 private:
  int medium_towards(const Vec3f& direction) const { return direction.dot(normal_) < 0 ? inside_ : outside_; }
  /// Points of one piece to be lit, of light of which `before` is left at its start.
  void scatter(const Ray& ray, std::ptrdiff_t index, const Vec3d& before, const ScatterDraw& draw,
               std::vector<ScatterVertex>& out) const;

  std::shared_ptr<const Shared> shared_;
  int here_ = -1;                   ///< where the next pass() begins
  int end_ = -1;                    ///< where the last one has ended
  int outside_ = -1, inside_ = -1;  ///< about the surface that the walk stands on
  Vec3f normal_{0};                 ///< of that surface; 0 in a medium
  bool on_surface_ = false;
  std::vector<MediumPiece> pieces_;
  Vec3d origin_{0}, direction_{0};  ///< of the last pass()
  std::vector<MediumPart> parts_;
  std::vector<Vec3d> before_;  ///< per part: the share of light that is left where it begins
  mutable std::vector<MediumPiece> shadow_pieces_;
  mutable std::vector<Crossing> crossings_;
};

Rgb Walk::pass(const Ray& ray, double distance, const ScatterDraw* draw, std::vector<ScatterVertex>& out) {
  const Media& media = shared_->media;
  end_ = media.pieces({ray.origin, ray.direction, distance, here_, on_surface_, std::isfinite(distance)},
                      crossings_, pieces_);
  origin_ = Vec3d(ray.origin);
  direction_ = Vec3d(ray.direction);
  parts_.clear();
  before_.clear();
  Vec3d left(1);
  for (const MediumPiece& piece : pieces_) {
    const Medium& medium = media.medium(piece.medium);
    if (medium.scatters()) {
      parts_.push_back({piece.t0, piece.t1, &shared_->phases[size_t(piece.medium)], piece.medium});
      before_.push_back(left);
    }
    if (draw != nullptr && medium.scatters()) scatter(ray, &piece - pieces_.data(), left, *draw, out);
    const MediumRay part{Vec3d(ray.origin), Vec3d(ray.direction), piece.t0, piece.t1};
    left *= penumbra::transmittance(medium, column(medium.density, part));
  }
  return to_rgb(left);
}

/// One point by free flight and one by the angle at the pivot, where there is one: each counts by the sum of
/// both densities (the balance heuristic). The pivot is the same for both, so its own density cancels.
void Walk::scatter(const Ray& ray, std::ptrdiff_t index, const Vec3d& before, const ScatterDraw& draw,
                   std::vector<ScatterVertex>& out) const {
  const MediumPiece& piece = pieces_[size_t(index)];
  const Medium& medium = shared_->media.medium(piece.medium);
  MediumRay part{Vec3d(ray.origin), Vec3d(ray.direction), piece.t0, draw.from};
  Vec3d left = before;
  if (part.t1 > part.t0) left *= penumbra::transmittance(medium, column(medium.density, part));
  part.t0 = std::max(piece.t0, draw.from);
  part.t1 = std::min(piece.t1, draw.until);
  if (!(part.t0 < part.t1)) return;
  const FreeFlight flight(medium, part);
  if (!flight.possible()) return;
  const std::optional<Equiangular> angle =
      draw.pivot ? std::optional<Equiangular>(Equiangular(part, *draw.pivot)) : std::nullopt;
  const bool by_angle = angle && angle->possible();
  for (int k = 0; k < (by_angle ? 2 : 1); ++k) {
    const PassSampler numbers = draw.sampler.branch(kScatterBranch + 2 * int(index) + k);
    const double u = numbers.select(draw.depth, kDistance);
    const ScatterPoint at =
        k == 0 ? flight.sample(u, numbers.select(draw.depth, kChannel)) : flight.point(angle->sample(u));
    const double density = flight.pdf(at) + (by_angle ? angle->pdf(at.t) : 0);
    if (!(density > 0) || !(at.density > 0)) continue;
    const Vec3d weight =
        left * penumbra::transmittance(medium, at.column) * medium.sigma_s * (at.density / density);
    if (!(weight.x + weight.y + weight.z > 0)) continue;
    out.push_back({Vec3f(part.o + part.d * at.t), &shared_->phases[size_t(piece.medium)], to_rgb(weight),
                   numbers, piece.medium});
  }
}

Rgb Walk::scattering(size_t part, double t) const {
  const Medium& medium = shared_->media.medium(parts_[part].medium);
  const MediumRay way{origin_, direction_, parts_[part].t0, t};
  const double density = density_at(medium.density, origin_ + direction_ * t);
  return to_rgb(before_[part] * penumbra::transmittance(medium, column(medium.density, way)) *
                medium.sigma_s * density);
}

void Walk::stand_on(uint32_t mesh, const Vec3f& ng) {
  const MediumSides& sides = shared_->media.sides(mesh);
  outside_ = sides.differ() ? sides.outside : here_;
  inside_ = sides.differ() ? sides.inside : here_;
  normal_ = ng;
  on_surface_ = true;
}

Rgb Walk::transmittance(const Vec3f& x, const Vec3f& wi, double distance) const {
  const Media& media = shared_->media;
  media.pieces({x, wi, distance, medium_towards(wi), on_surface_, std::isfinite(distance)}, crossings_,
               shadow_pieces_);
  Vec3d left(1);
  for (const MediumPiece& piece : shadow_pieces_) {
    const Medium& medium = media.medium(piece.medium);
    left *=
        penumbra::transmittance(medium, column(medium.density, {Vec3d(x), Vec3d(wi), piece.t0, piece.t1}));
  }
  return to_rgb(left);
}

class Stage final : public MediumStage {
 public:
  explicit Stage(Media media) {
    auto shared = std::make_shared<Shared>();
    for (int m = 0; m < media.size(); ++m) shared->phases.emplace_back(media.medium(m).phase);
    shared->media = std::move(media);
    shared_ = std::move(shared);
  }
  std::unique_ptr<MediumWalk> walk() const override { return std::make_unique<Walk>(shared_); }

 private:
  std::shared_ptr<const Shared> shared_;
};

bool calls_for_media(const SceneDescription& description) {
  for (const Need& need : needs_of(description))
    if (need.effect == "media") return true;
  return false;
}

}  // namespace

absl::StatusOr<std::shared_ptr<const MediumStage>> build_media(const SceneDescription& description,
                                                               const SceneFiles& files,
                                                               std::span<const ShapeEntity* const> shapes,
                                                               int threads) {
  if (!calls_for_media(description)) return nullptr;
  ASSIGN_OR_RETURN(Media media, Media::build(description, files, shapes, threads));
  if (media.size() == 0) return nullptr;
  return std::make_shared<const Stage>(std::move(media));
}

}  // namespace penumbra

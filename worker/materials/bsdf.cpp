#include "worker/materials/bsdf.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "proto/status.h"
#include "worker/materials/local_frame.h"
#include "worker/sampling/warp.h"

namespace penumbra {
namespace {

template <class L>
constexpr bool kSmooth = !std::decay_t<L>::kSpecular;

template <class L>
constexpr bool kLambertian =
    std::is_same_v<std::decay_t<L>, Lambert> || std::is_same_v<std::decay_t<L>, LambertTransmission>;

bool is_lambertian(const Lobe& lobe) {
  return std::visit([](const auto& kind) { return kLambertian<decltype(kind)>; }, lobe);
}

/// Facets reflect at most 1/(4π αx αy) of what comes along the normal into a steradian, where a Lambertian
/// surface has 1/π.
template <class L>
bool is_narrow(const L& lobe) {
  if constexpr (requires { lobe.facets; })
    return 4 * lobe.facets.alpha_x * lobe.facets.alpha_y * kNarrowPeak < 1;
  return kFibre<L>;
}

}  // namespace

/// A pair of directions in the shading frame, and where they lie about the geometric surface.
struct Bsdf::Pair {
  Vec3d wo, wi;
  bool reflects = false;   ///< both on one side of the geometric surface
  bool transmits = false;  ///< on opposite sides; neither where one of them lies in a surface
  template <class L>
  bool serves(const L&) const {
    if constexpr (kFibre<L>) return reflects || transmits;
    return L::kTransmits ? transmits : reflects;
  }
};

Bsdf::Bsdf(const SurfacePoint& point, const Vec3f& ns) : ng_(point.ng), ns_(ns) {
  const Vec3f tangent = point.dpdu - ns * (ns ^ point.dpdu);
  // A tangent along ns to rounding (2⁻²³ of its length; four times that for the products) has no direction
  // of its own. The negation also catches an undefined dpdu.
  if (!(tangent.length2() > 0x1p-42f * point.dpdu.length2())) {
    Vec3d s, t;
    frame(Vec3d(ns), s, t);
    ss_ = Vec3f(s);
    ts_ = Vec3f(t);
    return;
  }
  ss_ = tangent.normalized();
  ts_ = ns % ss_;
}

void Bsdf::add(const Lobe& lobe, const Rgb& scale) {
  const float share = std::max({scale.x, scale.y, scale.z});
  if (share <= 0) return;
  PENUMBRA_CHECK(count_ < kMostLobes);
  std::visit(
      [&](const auto& kind) {
        using L = std::decay_t<decltype(kind)>;
        transmits_ |= L::kTransmits && !L::kSpecular;
        specular_ += L::kSpecular;
        narrow_ |= is_narrow(kind);
        // Equal shares but for the scale, as in pbrt: a glossy lobe needs its samples more than its albedo
        // says, because light sampling serves it worst.
        lobes_[count_] = {lobe, scale, L::kSpecular ? 0 : share};
      },
      lobe);
  total_weight_ += lobes_[count_++].weight;
}

Vec3d Bsdf::to_local(const Vec3f& w) const {
  const Vec3d v(w);
  return {v ^ Vec3d(ss_), v ^ Vec3d(ts_), v ^ Vec3d(ns_)};
}

Vec3f Bsdf::to_world(const Vec3d& w) const {
  return Vec3f((Vec3d(ss_) * w.x + Vec3d(ts_) * w.y + Vec3d(ns_) * w.z).normalized());
}

Bsdf::Pair Bsdf::pair(const Vec3f& wo, const Vec3f& wi) const {
  Pair p{to_local(wo), to_local(wi)};
  const double side_o = Vec3d(wo) ^ Vec3d(ng_), side_i = Vec3d(wi) ^ Vec3d(ng_);
  const double least = std::min({std::abs(side_o), std::abs(side_i), abs_cos(p.wo), abs_cos(p.wi)});
  if (least < kLeastCosine) return p;
  p.reflects = (side_o > 0) == (side_i > 0);
  p.transmits = !p.reflects;
  return p;
}

Rgb Bsdf::f(const Pair& directions) const {
  Rgb sum(0);
  for (int i = 0; i < count_; ++i) {
    std::visit(
        [&](const auto& lobe) {
          if constexpr (kSmooth<decltype(lobe)>) {
            if (directions.serves(lobe)) {
              sum += lobes_[i].scale * penumbra::f(lobe, directions.wo, directions.wi);
            }
          }
        },
        lobes_[i].lobe);
  }
  return sum;
}

// The geometric normal decides between reflection and transmission (no light leaks), so some of a lobe's
// samples, drawn about the shading normal, are on the wrong side: above the shading horizon and below the
// geometric one, or the reverse. The antipode of such a direction is right, has the same |cosθ|, and is
// in the region that the lobe would never sample though f is not zero there. sample() takes it; so the
// density at a direction is that of the lobe there plus that at the antipode.
double Bsdf::pdf(const Pair& directions) const {
  double sum = 0;
  for (int i = 0; i < count_; ++i) {
    std::visit(
        [&](const auto& lobe) {
          if constexpr (kSmooth<decltype(lobe)>) {
            if (!directions.serves(lobe)) return;
            double density = penumbra::pdf(lobe, directions.wo, directions.wi);
            if constexpr (lobe.kFolds) density += penumbra::pdf(lobe, directions.wo, -directions.wi);
            sum += lobes_[i].weight * density;
          }
        },
        lobes_[i].lobe);
  }
  return sum > 0 ? sum / total_weight_ : 0;
}

Rgb Bsdf::f(const Vec3f& wo, const Vec3f& wi) const {
  return f(pair(wo, wi));
}

Rgb Bsdf::lambertian(bool reflected) const {
  Rgb sum(0);
  const Vec3d any(0, 0, 1);
  for (int i = 0; i < count_; ++i) {
    std::visit(
        [&](const auto& lobe) {
          if constexpr (kLambertian<decltype(lobe)>) {
            if (lobe.kTransmits != reflected) sum += lobes_[i].scale * penumbra::f(lobe, any, any);
          }
        },
        lobes_[i].lobe);
  }
  return sum;
}

Rgb Bsdf::f_beyond_lambertian(const Vec3f& wo, const Vec3f& wi) const {
  const Pair directions = pair(wo, wi);
  Rgb sum(0);
  for (int i = 0; i < count_; ++i) {
    std::visit(
        [&](const auto& lobe) {
          if constexpr (kSmooth<decltype(lobe)> && !kLambertian<decltype(lobe)>) {
            if (directions.serves(lobe))
              sum += lobes_[i].scale * penumbra::f(lobe, directions.wo, directions.wi);
          }
        },
        lobes_[i].lobe);
  }
  return sum;
}

bool Bsdf::only_lambertian() const {
  for (int i = 0; i < count_; ++i)
    if (lobes_[i].weight > 0 && !is_lambertian(lobes_[i].lobe)) return false;
  return true;
}

double Bsdf::pdf(const Vec3f& wo, const Vec3f& wi) const {
  return pdf(pair(wo, wi));
}

/// Leaves of `choice` what has not been used up, again in [0,1].
const Bsdf::Weighted& Bsdf::choose(double& choice) const {
  double rest = choice * total_weight_;
  int last = 0;
  for (int i = 0; i < count_; ++i) {
    if (lobes_[i].weight == 0) continue;
    last = i;
    if (rest < lobes_[i].weight) break;
    rest -= lobes_[i].weight;
  }
  choice = std::min(rest / lobes_[last].weight, 1.);
  return lobes_[last];
}

std::optional<BsdfSample> Bsdf::sample(const Vec3f& wo, const Vec2d& u, double choice) const {
  if (!has_non_specular()) return std::nullopt;
  const Vec3d local_wo = to_local(wo);
  if (abs_cos(local_wo) < kLeastCosine) return std::nullopt;
  BsdfSample result;
  const Weighted& chosen = choose(choice);
  const bool found = std::visit(
      [&](const auto& lobe) {
        using L = std::decay_t<decltype(lobe)>;
        if constexpr (kFibre<L>) {
          const std::optional<Vec3d> local = penumbra::sample(lobe, local_wo, u, choice);
          if (local) result.wi = to_world(*local);
          return local.has_value();
        } else if constexpr (kSmooth<L>) {
          const std::optional<Vec3d> local = penumbra::sample(lobe, local_wo, u);
          if (!local) return false;
          result.wi = to_world(*local);
          const bool same_side = (Vec3d(wo) ^ Vec3d(ng_)) * (Vec3d(result.wi) ^ Vec3d(ng_)) > 0;
          if (lobe.kFolds && same_side == lobe.kTransmits) result.wi = -result.wi;
          return true;
        } else {
          return false;
        }
      },
      chosen.lobe);
  if (!found) return std::nullopt;
  // From the rounded direction, so that pdf() and f() of the caller give the same numbers.
  const Pair directions = pair(wo, result.wi);
  result.pdf = pdf(directions);
  if (!(result.pdf > 0)) return std::nullopt;
  result.f = f(directions);
  return result;
}

std::optional<BsdfSample> Bsdf::sample_specular(const Vec3f& wo, int index) const {
  const Vec3d local_wo = to_local(wo);
  if (abs_cos(local_wo) < kLeastCosine) return std::nullopt;
  for (int i = 0; i < count_; ++i) {
    if (lobes_[i].weight > 0 || index-- > 0) continue;
    return std::visit(
        [&](const auto& lobe) -> std::optional<BsdfSample> {
          if constexpr (kSmooth<decltype(lobe)>) {
            return std::nullopt;
          } else {
            const auto direction = penumbra::scatter(lobe, local_wo);
            if (!direction) return std::nullopt;
            return BsdfSample{to_world(direction->wi), lobes_[i].scale * direction->f, 1, true};
          }
        },
        lobes_[i].lobe);
  }
  PENUMBRA_CHECK(!"specular lobe index out of range");
  return std::nullopt;
}

}  // namespace penumbra

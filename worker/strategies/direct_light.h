#pragma once
// Direct light at a shading point: one loop over all strategies of a mix, whatever they are.
#include <limits>
#include <span>
#include <vector>

#include "worker/geometry/geometry.h"
#include "worker/sampling/sampler.h"
#include "worker/strategies/arrivals.h"
#include "worker/strategies/attenuation.h"
#include "worker/strategies/combination.h"
#include "worker/strategies/light_set.h"
#include "worker/strategies/light_sight.h"
#include "worker/strategies/lights_now.h"
#include "worker/strategies/line_batch.h"
#include "worker/strategies/prepared_mix.h"
#include "worker/strategies/shading_point.h"
#include "worker/strategies/strategy.h"

namespace penumbra {

/// What the loop needs of the scene.
struct Surroundings {
  const Geometry& geometry;
  const LightSet& lights;
  const Attenuation* attenuation = nullptr;  ///< null: nothing but surfaces is in the way of light
  /// Also told of all light; the path stands at the point. Null: nobody asks when.
  Arrivals* arrivals = nullptr;
};

/// Estimator of the direct light that a point scatters towards its viewer. Keeps scratch memory between
/// calls; one per thread. Every call is a pure function of its arguments.
class DirectLight {
 public:
  DirectLight(const Surroundings& surroundings, const PreparedMix& mix, QueryCounters& counters)
      : scene_(surroundings), mix_(mix), counters_(counters), now_(surroundings.lights, &mix) {}

  /// Outgoing radiance at the point due to all lights; `depth` is the vertex's place on the path.
  Rgb estimate(const ShadingPoint& point, const PassSampler& sampler, int depth);

  /// What the mix makes of one point of an area light, whichever strategy may find it; for `converge
  /// --integrand`. A row per slot: the density that the weights are made of (sr⁻¹ at x), and the weight. The
  /// weights sum to 1 unless no strategy can find the point. f is 0 where the point is hidden.
  struct Integrand {
    Rgb f{0};  ///< BSDF × cosine × radiance × visibility
    double smoothing = 1;
    std::vector<double> densities, weights;
  };
  Integrand integrand(const ShadingPoint& point, size_t area_emitter, const Vec3d& on_light);

 private:
  static constexpr size_t kNoLine = std::numeric_limits<size_t>::max();
  /// What is known of the way to a candidate: a ray has gone it; no opaque surface is in it; nothing.
  enum class Sight { kTraced, kNoOpaque, kUnknown };
  /// A direction that some strategy found, on its way to its weight.
  struct Candidate {
    LightSample sample;
    Rgb f{0};         ///< BSDF × cosine × radiance
    size_t slot = 0;  ///< of the strategy that found it
    size_t line = 0;  ///< of its own line in the batch, if its strategy is a line
    double s = 0;     ///< where on that line
    Sight sight = Sight::kUnknown;
    double visible = 1, smoothing = 1;  ///< see Found
  };
  struct BsdfHit {
    size_t light = 0;  ///< area emitters first, then environments
    LightSample sample;
    size_t slot = 0;
  };
  /// One light from one point, with the strategies that serve it.
  struct Task {
    const LightView& view;
    size_t light = 0;  ///< area emitters first, then environments
    double draws = 1;  ///< expected number of times the light is asked
    /// The draws that fell on it: their samples are some of those of all `draws_in_all` draws, in the pattern
    /// of `stream`. Empty: only what bsdf met counts.
    std::span<const int> turns;
    int draws_in_all = 1;
    uint32_t stream = 0;
    /// Of a light that moves: its strategies at the point's time, per slot.
    const std::vector<Strategy>* strategies = nullptr;
    PreparedMix::Slot slot(const PreparedMix& mix, size_t s) const {
      if (strategies != nullptr) return {(*strategies)[s], mix.count(s)};
      return mix.slot(light, s);
    }
  };

  static bool is_black(const Rgb& c) { return c.x == 0 && c.y == 0 && c.z == 0; }

  Rgb draw_lights(const ShadingPoint& point, const PassSampler& sampler, int depth);
  /// A length that leads from the point past everything.
  float reach(const ShadingPoint& point) const;
  LightView view_of(const ShadingPoint& point, size_t light);
  Rgb ask(const Task& task, const PassSampler& sampler, int depth);
  Rgb answer(const Task& task, const PassSampler& sampler, int depth);
  // direct_light_arrivals.cpp
  void arrive(const Task& task, const PassSampler& sampler, int depth);
  void arrive(const Task& task, size_t candidate);
  void spread(const Task& task, size_t slot, size_t line, double v);
  /// `weight`: what its being drawn among many counts for.
  Rgb delta(const ShadingPoint& point, const DeltaEmitter& emitter, float weight);

  // direct_light_gather.cpp
  void trace_bsdf(const ShadingPoint& point, const PassSampler& sampler, int depth);
  void gather_bsdf(const Task& task);
  void gather_points(const Task& task, const PassSampler& sampler, int depth);
  void gather_lines(const Task& task, const PassSampler& sampler, int depth);
  void choose_lines(const Task& task, const PassSampler& sampler, int depth);
  /// The two numbers of sample i of a slot's in a turn: which line, and where on it.
  Vec2d numbers(const Task& task, size_t slot, int turn, int i, const PassSampler& sampler, int depth) const;
  void push(const Task& task, const LightSample& sample, size_t slot, Sight sight, size_t line, double s);
  bool integrates(const Strategy& strategy) const;
  /// False: no sample of the light can count here.
  bool may_reach(const Task& task);
  // direct_light_sight.cpp
  /// Sets densities_ (row per candidate, as the estimate needs them and as the weights need them) and
  /// drops candidates that nothing reaches.
  void resolve(const Task& task);
  void densities(const Task& task, Candidate& candidate, double* row);
  /// Takes from every candidate what is lost on its way.
  void attenuate(const Task& task);
  bool clear(const Task& task, const LightSample& sample);

  Rgb combine();
  void start_combiner(const Task& task);
  Found found(size_t candidate, size_t slot) const;

  Surroundings scene_;
  const PreparedMix& mix_;
  QueryCounters& counters_;
  LightsNow now_;

  std::vector<BsdfHit> hits_;
  std::vector<Candidate> candidates_;
  LightSight sight_;
  LineBatch own_lines_, foreign_lines_;
  std::vector<size_t> foreign_;    ///< row per candidate, a handle per slot
  std::vector<double> densities_;  ///< row per candidate, a density per slot
  Rgb integrated_{0};              ///< by analytic lines, of the light being asked
  std::vector<DrawnLight> drawn_;
  std::vector<int> turns_;
  std::vector<double> expected_;  ///< samples per slot
  std::vector<bool> line_slots_;  ///< whether it is a line strategy
  Combiner combiner_;
  // For arrivals: the parts of a line; of each candidate, its part's bin and its share in the line's visible
  // measure.
  std::vector<LinePart> parts_;
  std::vector<int> bins_;
  std::vector<double> shares_;
};

}  // namespace penumbra

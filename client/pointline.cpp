#include "client/pointline.h"

#include <algorithm>
#include <cmath>

#include "proto/status.h"

namespace penumbra {
namespace {

// More light samples than this at one shading point is a typing error (the same bound as of --mix).
constexpr int64_t kMostSamples = 65536;

std::string place_of(const SceneDescription& scene, const char* parameter) {
  const Param* p = scene.integrator.params.find(parameter);
  return scene.place(p != nullptr ? p->loc : scene.integrator.loc);
}

absl::StatusOr<StrategyCount> strategy(const SceneDescription& scene, const std::string& name, int number) {
  const std::string angle_name = fmt::format("angle{}", number);
  const double angle = scene.integrator.params.number(angle_name, 0);
  StrategyCount s;
  if (name == "brdf") {
    s.kind = StrategyKind::kBsdf;
  } else if (name == "pt-surf-area") {
    s.kind = StrategyKind::kArea;
  } else if (name == "pt-solid-angle") {
    s.kind = StrategyKind::kSolidAngle;
  } else if (name == "line-surf-area") {
    if (!(angle >= 0 && angle <= 1))
      return invalid_input("{}: {} {} is not in [0,1]", place_of(scene, angle_name.c_str()), angle_name,
                           angle);
    s.kind = StrategyKind::kLineArea;
    s.angle_degrees = std::fmod(180 * angle + 90, 180);
  } else if (name == "line-solid-angle") {
    if (angle != 0 && angle != 1)
      return invalid_input("{}: {} {}: line-solid-angle knows 0 (edge u) and 1 (edge v)",
                           place_of(scene, angle_name.c_str()), angle_name, angle);
    s.kind = angle == 0 ? StrategyKind::kLineSolidAngleU : StrategyKind::kLineSolidAngleV;
  } else {
    return invalid_input(
        "{}: unknown strategy '{}'; there are brdf, pt-surf-area, pt-solid-angle, "
        "line-surf-area, line-solid-angle",
        place_of(scene, fmt::format("strategy{}", number).c_str()), name);
  }
  return s;
}

/// xsamples × ysamples of the first area light; the authors' scenes give all lights the same.
absl::StatusOr<int64_t> light_samples(const SceneDescription& scene, std::vector<std::string>& notes) {
  std::optional<int64_t> samples;
  for (const Entity& light : scene.area_lights) {
    const int64_t x = light.params.integer("xsamples", 1), y = light.params.integer("ysamples", 1);
    if (x < 1 || y < 1 || x > kMostSamples || y > kMostSamples || x * y > kMostSamples)
      return invalid_input("{}: AreaLightSource: {} x {} samples is out of range", scene.place(light.loc), x,
                           y);
    if (samples && *samples != x * y) {
      notes.push_back(
          fmt::format("{}: AreaLightSource: {} samples; the counts of the first light, {}, serve all",
                      scene.place(light.loc), x * y, *samples));
      break;
    }
    samples = samples.value_or(x * y);
  }
  return samples.value_or(1);
}

void share_out(const SceneDescription& scene, int64_t total, Mix& mix, std::vector<std::string>& notes) {
  const auto n = static_cast<int64_t>(mix.strategies.size());
  std::vector<int64_t> counts(mix.strategies.size(), 1);
  const bool stratified = scene.integrator.params.boolean("stratified", false);
  const double ratio = scene.integrator.params.number("ratio", 0.5);
  const auto rounded = [&](double value) {
    return static_cast<int64_t>(std::clamp(value, 0.0, static_cast<double>(total)));
  };
  if (total > 1 && n == 1) {
    counts = {total};
  } else if (total > 1 && !stratified && n == 2) {
    counts = {rounded(std::floor(ratio * static_cast<double>(total))), 0};
    counts[1] = total - counts[0];
  } else if (total > 1 && !stratified && n == 3 &&
             2 * rounded(std::ceil(ratio * static_cast<double>(total))) <= total) {
    counts[0] = counts[1] = rounded(std::ceil(ratio * static_cast<double>(total)));
    counts[2] = total - counts[0] - counts[1];
  } else if (total > 1) {
    for (int64_t i = 0; i < n; ++i) counts[static_cast<size_t>(i)] = std::max<int64_t>(1, total / n);
    if (total % n != 0)
      notes.push_back(fmt::format("{}: {} light samples shared among {} strategies: {} each",
                                  scene.place(scene.integrator.loc), total, n, counts[0]));
  }
  for (size_t i = 0; i < counts.size(); ++i) mix.strategies[i].count = static_cast<int>(counts[i]);
  std::erase_if(mix.strategies, [](const StrategyCount& s) { return s.count == 0; });
}

absl::Status combine(const SceneDescription& scene, Mix& mix, std::vector<std::string>& notes) {
  const Params& p = scene.integrator.params;
  const double width = p.number("smoothstep", 0);
  if (!(width >= 0) || !std::isfinite(width))
    return invalid_input("{}: smoothstep {} is negative or not finite", place_of(scene, "smoothstep"), width);
  mix.combination = p.boolean("mis", true) ? Combination::kBalance : Combination::kAverage;
  if (width == 0 || mix.combination == Combination::kAverage) return absl::OkStatus();
  const bool has_line = std::any_of(mix.strategies.begin(), mix.strategies.end(),
                                    [](const StrategyCount& s) { return is_line(s.kind); });
  if (!has_line) {
    notes.push_back(
        fmt::format("{}: smoothstep without a line strategy does nothing", place_of(scene, "smoothstep")));
    return absl::OkStatus();
  }
  mix.combination = Combination::kSmooth;
  mix.smooth_width = width;
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Mix> pointline_mix(const SceneDescription& scene, std::vector<std::string>& notes) {
  Mix mix;
  for (int number = 1; number <= 3; ++number) {
    const std::string name = scene.integrator.params.string(fmt::format("strategy{}", number), "none");
    if (name == "none") continue;
    ASSIGN_OR_RETURN(const StrategyCount s, strategy(scene, name, number));
    mix.strategies.push_back(s);
  }
  if (mix.strategies.empty())
    return invalid_input("{}: Integrator \"pointline\" names no strategy", scene.place(scene.integrator.loc));
  ASSIGN_OR_RETURN(const int64_t samples, light_samples(scene, notes));
  share_out(scene, samples, mix, notes);
  RETURN_IF_ERROR(combine(scene, mix, notes));
  return mix;
}

}  // namespace penumbra

#include "proto/mix.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "proto/status.h"

namespace penumbra {
namespace {

// A mix with more samples than this at one shading point is a typing error, not a wish.
constexpr int kMostSamples = 65536;
// So that the normal form of a mix, which may be longer than what was written, stays short.
constexpr size_t kMostStrategies = 64;

absl::Status fault(std::string_view word, std::string_view why) {
  return invalid_input("--mix: '{}': {}", word, why);
}

/// The whole of the text as a number, or nothing.
template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool consume_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

absl::StatusOr<double> parse_angle(std::string_view word, std::string_view text) {
  const auto degrees = number<double>(text);
  if (!degrees || !std::isfinite(*degrees))
    return fault(word, "the angle after '@' must be a number of degrees");
  const double turned = std::fmod(*degrees, 180.0);
  return turned < 0 ? turned + 180.0 : turned;
}

absl::StatusOr<StrategyCount> parse_strategy(std::string_view word) {
  StrategyCount s;
  std::string_view name = word;
  if (const size_t colon = word.find(':'); colon != std::string_view::npos) {
    name = word.substr(0, colon);
    const auto count = number<int>(word.substr(colon + 1));
    if (!count || *count < 1 || *count > kMostSamples)
      return fault(word, fmt::format("the count must be a whole number from 1 to {}", kMostSamples));
    s.count = *count;
  }
  if (name == "bsdf") {
    s.kind = StrategyKind::kBsdf;
    return s;
  }
  if (name == "area") {
    s.kind = StrategyKind::kArea;
    return s;
  }
  if (name == "sa") {
    s.kind = StrategyKind::kSolidAngle;
    return s;
  }
  if (name == "visible-area") {
    s.kind = StrategyKind::kVisibleArea;
    return s;
  }
  if (name == "line-sa@u") {
    s.kind = StrategyKind::kLineSolidAngleU;
    return s;
  }
  if (name == "line-sa@v") {
    s.kind = StrategyKind::kLineSolidAngleV;
    return s;
  }
  constexpr std::pair<std::string_view, StrategyKind> kAtAnAngle[] = {
      {"line-area@", StrategyKind::kLineArea},
      {"line-uniform@", StrategyKind::kLineUniform},
      {"line-analytic@", StrategyKind::kLineAnalytic}};
  for (const auto& [prefix, kind] : kAtAnAngle) {
    if (!consume_prefix(name, prefix)) continue;
    s.kind = kind;
    ASSIGN_OR_RETURN(s.angle_degrees, parse_angle(word, name));
    return s;
  }
  return fault(word,
               "unknown strategy; there are bsdf, area, sa, visible-area, line-area@DEG, line-sa@u, "
               "line-sa@v, line-uniform@DEG, line-analytic@DEG and, alone, auto");
}

absl::Status parse_combination(std::string_view word, Mix& mix) {
  if (word == "balance")
    mix.combination = Combination::kBalance;
  else if (word == "free")
    mix.combination = Combination::kFree;
  else if (word == "power")
    mix.combination = Combination::kPower;
  else if (word == "average")
    mix.combination = Combination::kAverage;
  else if (const bool eases = consume_prefix(word, "smooth-ease=");
           eases || consume_prefix(word, "smooth=")) {
    mix.combination = Combination::kSmooth;
    mix.smooth_shape = eases ? SmoothShape::kEaseIn : SmoothShape::kCubic;
    if (word == "auto") return absl::OkStatus();
    const auto width = number<double>(word);
    if (!width || !(*width > 0) || !std::isfinite(*width))
      return fault(word, "the width of smooth= and smooth-ease= must be a positive number or auto");
    mix.smooth_width = *width;
  } else {
    return fault(word,
                 "unknown combination; there are balance, free, power, average, smooth=WIDTH|auto, "
                 "smooth-ease=WIDTH|auto, and after it lens=point|line, medium=point|line, motion=point|line "
                 "and pixel=point|line");
  }
  return absl::OkStatus();
}

/// How one effect is sampled: `lens=point`, …
struct EffectWord {
  std::string_view prefix, fault;
  void (*set)(Mix& mix, bool line);
};
constexpr EffectWord kEffectWords[] = {
    {"lens=", "a lens is sampled by lens=point or lens=line",
     [](Mix& mix, bool line) { mix.lens = line ? LensSampling::kLine : LensSampling::kPoint; }},
    {"medium=", "media are lit by medium=point or medium=line",
     [](Mix& mix, bool line) { mix.medium = line ? MediumSampling::kLine : MediumSampling::kPoint; }},
    {"motion=", "motion is sampled by motion=point or motion=line",
     [](Mix& mix, bool line) { mix.motion = line ? MotionSampling::kLine : MotionSampling::kPoint; }},
    {"pixel=", "pixels are sampled by pixel=point or pixel=line",
     [](Mix& mix, bool line) { mix.pixel = line ? PixelSampling::kLine : PixelSampling::kPoint; }}};

/// Reads one of kEffectWords, none of which may stand twice; `said`: those that did. False: another word.
absl::StatusOr<bool> parse_effect(std::string_view word, Mix& mix, std::set<std::string_view>& said) {
  for (const EffectWord& effect : kEffectWords) {
    std::string_view value = word;
    if (!consume_prefix(value, effect.prefix)) continue;
    if (value != "point" && value != "line") return fault(value, effect.fault);
    if (!said.insert(effect.prefix).second) return fault(word, fmt::format("{} stands twice", effect.prefix));
    effect.set(mix, value == "line");
    return true;
  }
  return false;
}

/// What stands behind the strategies, each after a slash: a combination, then how effects are sampled.
absl::Status parse_rest(std::string_view rest, Mix& mix) {
  std::set<std::string_view> effects;
  for (bool first = true; !rest.empty(); first = false) {
    const size_t slash = std::min(rest.find('/', 1), rest.size());
    const std::string_view word = rest.substr(1, slash - 1);
    rest.remove_prefix(slash);
    ASSIGN_OR_RETURN(const bool effect, parse_effect(word, mix, effects));
    if (effect) continue;
    if (!effects.empty()) return fault(word, "lens=, medium=, motion= and pixel= must stand last");
    if (!first)
      return fault(word,
                   "after the combination there is only lens=point|line, medium=point|line, "
                   "motion=point|line and pixel=point|line");
    RETURN_IF_ERROR(parse_combination(word, mix));
  }
  return absl::OkStatus();
}

std::string name_of(const StrategyCount& s) {
  switch (s.kind) {
    case StrategyKind::kBsdf:
      return "bsdf";
    case StrategyKind::kArea:
      return "area";
    case StrategyKind::kSolidAngle:
      return "sa";
    case StrategyKind::kVisibleArea:
      return "visible-area";
    case StrategyKind::kLineArea:
      return fmt::format("line-area@{}", s.angle_degrees);
    case StrategyKind::kLineSolidAngleU:
      return "line-sa@u";
    case StrategyKind::kLineSolidAngleV:
      return "line-sa@v";
    case StrategyKind::kLineUniform:
      return fmt::format("line-uniform@{}", s.angle_degrees);
    case StrategyKind::kLineAnalytic:
      return fmt::format("line-analytic@{}", s.angle_degrees);
  }
  std::abort();
}

std::string name_of(const Mix& mix) {
  switch (mix.combination) {
    case Combination::kBalance:
      return "balance";
    case Combination::kFree:
      return "free";
    case Combination::kPower:
      return "power";
    case Combination::kAverage:
      return "average";
    case Combination::kSmooth:
      return fmt::format("{}={}", mix.smooth_shape == SmoothShape::kEaseIn ? "smooth-ease" : "smooth",
                         mix.smooth_width ? fmt::format("{}", *mix.smooth_width) : "auto");
  }
  std::abort();
}

}  // namespace

bool is_line(StrategyKind kind) {
  switch (kind) {
    case StrategyKind::kBsdf:
    case StrategyKind::kArea:
    case StrategyKind::kSolidAngle:
    case StrategyKind::kVisibleArea:
      return false;
    case StrategyKind::kLineArea:
    case StrategyKind::kLineSolidAngleU:
    case StrategyKind::kLineSolidAngleV:
    case StrategyKind::kLineUniform:
    case StrategyKind::kLineAnalytic:
      return true;
  }
  std::abort();
}

int Mix::samples() const {
  int n = 0;
  for (const StrategyCount& s : strategies) n += s.count;
  return n;
}

absl::StatusOr<Mix> parse_mix(std::string_view text) {
  Mix mix;
  if (text == "auto") {
    mix.automatic = true;
    return mix;
  }
  std::string_view sum = text;
  if (const size_t slash = text.find('/'); slash != std::string_view::npos) {
    sum = text.substr(0, slash);
    RETURN_IF_ERROR(parse_rest(text.substr(slash), mix));
  }
  for (;;) {
    const size_t plus = sum.find('+');
    ASSIGN_OR_RETURN(const StrategyCount strategy, parse_strategy(sum.substr(0, plus)));
    mix.strategies.push_back(strategy);
    if (plus == std::string_view::npos) break;
    if (mix.strategies.size() == kMostStrategies)
      return fault(text, fmt::format("more than {} strategies", kMostStrategies));
    sum.remove_prefix(plus + 1);
  }
  if (mix.samples() > kMostSamples) return fault(text, fmt::format("more than {} samples", kMostSamples));
  const bool has_line = std::any_of(mix.strategies.begin(), mix.strategies.end(),
                                    [](const StrategyCount& s) { return is_line(s.kind); });
  if (mix.combination == Combination::kSmooth && !has_line)
    return fault(text, "smoothing needs a line strategy in the mix");
  return mix;
}

std::string label(const Mix& mix) {
  if (mix.automatic) return "auto";
  std::string out;
  for (const StrategyCount& s : mix.strategies)
    out += fmt::format("{}{}:{}", out.empty() ? "" : "+", name_of(s), s.count);
  return fmt::format("{}/{}{}{}{}{}", out, name_of(mix), mix.lens == LensSampling::kLine ? "/lens=line" : "",
                     mix.medium == MediumSampling::kLine ? "/medium=line" : "",
                     mix.motion == MotionSampling::kLine ? "/motion=line" : "",
                     mix.pixel == PixelSampling::kLine ? "/pixel=line" : "");
}

std::vector<std::string> labels(const std::vector<Mix>& mixes) {
  std::map<std::string, int> seen;
  std::vector<std::string> out;
  for (const Mix& mix : mixes) {
    std::string l = label(mix);
    const int n = ++seen[l];
    out.push_back(n == 1 ? l : fmt::format("{}#{}", l, n));
  }
  return out;
}

std::string file_stem(std::string_view label) {
  std::string stem(label);
  for (char& c : stem) {
    if (c == '/') c = '_';
    if (c == ':' || c == '@' || c == '=') c = '-';
  }
  return stem;
}

}  // namespace penumbra

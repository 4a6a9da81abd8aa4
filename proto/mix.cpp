#include "proto/mix.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace penumbra {
namespace {

// A mix with more samples than this at one shading point is a typing error, not a wish.
constexpr int kMostSamples = 65536;

absl::Status fault(std::string_view word, std::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat("--mix: '", word, "': ", why));
}

/// Shortest decimal that reads back as the same double.
std::string shortest(double x) {
  for (int digits = 1; digits < 17; ++digits) {
    std::string s = absl::StrFormat("%.*g", digits, x);
    double back = 0;
    if (absl::SimpleAtod(s, &back) && back == x) return s;
  }
  return absl::StrFormat("%.17g", x);
}

absl::StatusOr<double> parse_angle(std::string_view word, std::string_view text) {
  double degrees = 0;
  if (!absl::SimpleAtod(text, &degrees) || !std::isfinite(degrees))
    return fault(word, "the angle after '@' must be a number of degrees");
  const double turned = std::fmod(degrees, 180.0);
  return turned < 0 ? turned + 180.0 : turned;
}

absl::StatusOr<StrategyCount> parse_strategy(std::string_view word) {
  StrategyCount s;
  std::string_view name = word;
  if (const size_t colon = word.find(':'); colon != std::string_view::npos) {
    name = word.substr(0, colon);
    if (!absl::SimpleAtoi(word.substr(colon + 1), &s.count) || s.count < 1 || s.count > kMostSamples)
      return fault(word, absl::StrCat("the count must be a whole number from 1 to ", kMostSamples));
  }
  if (name == "bsdf") { s.kind = StrategyKind::kBsdf; return s; }
  if (name == "area") { s.kind = StrategyKind::kArea; return s; }
  if (name == "sa") { s.kind = StrategyKind::kSolidAngle; return s; }
  if (name == "line-sa@u") { s.kind = StrategyKind::kLineSolidAngleU; return s; }
  if (name == "line-sa@v") { s.kind = StrategyKind::kLineSolidAngleV; return s; }
  const bool analytic = absl::ConsumePrefix(&name, "line-analytic@");
  if (analytic || absl::ConsumePrefix(&name, "line-area@")) {
    s.kind = analytic ? StrategyKind::kLineAnalytic : StrategyKind::kLineArea;
    auto angle = parse_angle(word, name);
    if (!angle.ok()) return angle.status();
    s.angle_degrees = *angle;
    return s;
  }
  return fault(word, "unknown strategy; there are bsdf, area, sa, line-area@DEG, line-sa@u, line-sa@v, "
                     "line-analytic@DEG and, alone, auto");
}

absl::Status parse_combination(std::string_view word, Mix& mix) {
  if (word == "balance") mix.combination = Combination::kBalance;
  else if (word == "free") mix.combination = Combination::kFree;
  else if (word == "power") mix.combination = Combination::kPower;
  else if (word == "average") mix.combination = Combination::kAverage;
  else if (absl::ConsumePrefix(&word, "smooth=")) {
    mix.combination = Combination::kSmooth;
    if (word == "auto") return absl::OkStatus();
    double width = 0;
    if (!absl::SimpleAtod(word, &width) || !(width > 0) || !std::isfinite(width))
      return fault(word, "the width of smooth= must be a positive number or auto");
    mix.smooth_width = width;
  } else {
    return fault(word, "unknown combination; there are balance, free, power, average, smooth=WIDTH|auto");
  }
  return absl::OkStatus();
}

std::string name_of(const StrategyCount& s) {
  switch (s.kind) {
    case StrategyKind::kBsdf: return "bsdf";
    case StrategyKind::kArea: return "area";
    case StrategyKind::kSolidAngle: return "sa";
    case StrategyKind::kLineArea: return absl::StrCat("line-area@", shortest(s.angle_degrees));
    case StrategyKind::kLineSolidAngleU: return "line-sa@u";
    case StrategyKind::kLineSolidAngleV: return "line-sa@v";
    case StrategyKind::kLineAnalytic: return absl::StrCat("line-analytic@", shortest(s.angle_degrees));
  }
  std::abort();
}

std::string name_of(const Mix& mix) {
  switch (mix.combination) {
    case Combination::kBalance: return "balance";
    case Combination::kFree: return "free";
    case Combination::kPower: return "power";
    case Combination::kAverage: return "average";
    case Combination::kSmooth:
      return absl::StrCat("smooth=", mix.smooth_width ? shortest(*mix.smooth_width) : "auto");
  }
  std::abort();
}

}  // namespace

bool is_line(StrategyKind kind) {
  return kind == StrategyKind::kLineArea || kind == StrategyKind::kLineSolidAngleU ||
         kind == StrategyKind::kLineSolidAngleV || kind == StrategyKind::kLineAnalytic;
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
    if (absl::Status s = parse_combination(text.substr(slash + 1), mix); !s.ok()) return s;
  }
  for (std::string_view word : absl::StrSplit(sum, '+')) {
    auto strategy = parse_strategy(word);
    if (!strategy.ok()) return strategy.status();
    mix.strategies.push_back(*strategy);
  }
  if (mix.samples() > kMostSamples) return fault(text, absl::StrCat("more than ", kMostSamples, " samples"));
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
    absl::StrAppend(&out, out.empty() ? "" : "+", name_of(s), ":", s.count);
  return absl::StrCat(out, "/", name_of(mix));
}

std::vector<std::string> labels(const std::vector<Mix>& mixes) {
  std::map<std::string, int> seen;
  std::vector<std::string> out;
  for (const Mix& mix : mixes) {
    std::string l = label(mix);
    const int n = ++seen[l];
    out.push_back(n == 1 ? l : absl::StrCat(l, "#", n));
  }
  return out;
}

std::string file_stem(std::string_view label) {
  return absl::StrReplaceAll(label, {{"/", "_"}, {":", "-"}, {"@", "-"}, {"=", "-"}});
}

}  // namespace penumbra

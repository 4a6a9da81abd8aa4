#pragma once
// A mix says how the light samples of a shading point are made: which strategies, how many of each,
// how they are combined. Client, server and worker speak of mixes in these words.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace penumbra {

enum class StrategyKind {
  kBsdf,             ///< `bsdf`: direction from the material's lobes
  kArea,             ///< `area`: point uniform on the light's surface
  kSolidAngle,       ///< `sa`: point uniform in the solid angle of the light's shape
  kLineArea,         ///< `line-area@DEG`: chord at DEG from edge u, offset by chord length
  kLineSolidAngleU,  ///< `line-sa@u`: chord parallel to edge u, uniform solid angle
  kLineSolidAngleV,  ///< `line-sa@v`: chord parallel to edge v, uniform solid angle
  kLineUniform,      ///< `line-uniform@DEG`: as kLineArea, but offset uniform across the light
  kLineAnalytic,     ///< `line-analytic@DEG`: Billen & Dutré 2016
  kVisibleArea,      ///< `visible-area`: point uniform in the solid angle of what is visible of the light
};

/// True where the strategy chooses a line first and knows its visible part (`visible-area` has no line).
bool is_line(StrategyKind kind);

struct StrategyCount {
  StrategyKind kind = StrategyKind::kBsdf;
  double angle_degrees = 0;  ///< of the kinds with `@DEG`, in [0,180)
  int count = 1;             ///< samples per shading point and light, >= 1
  bool operator==(const StrategyCount&) const = default;
};

enum class Combination { kBalance, kFree, kPower, kAverage, kSmooth };
/// How `smooth=` falls to 0: the paper's cubic smoothstep, or `smooth-ease=`, the ease-in 2t − t².
enum class SmoothShape { kCubic, kEaseIn };

/// How single scattering in media is lit: at points of the camera's ray, or on the parts of it that a point
/// of a light sees, which are known exactly. Nothing where there are no media.
enum class MediumSampling { kPoint, kLine };
/// How the lens of a camera that has one is sampled: by points of it, or by chords of it, along which what is
/// seen is known exactly. Nothing where the camera is a pinhole.
enum class LensSampling { kPoint, kLine };

/// How the time while the shutter is open is sampled where something moves: by points in time, or by the
/// intervals of time in which a camera ray sees one thing, which are known. Nothing where nothing moves.
enum class MotionSampling { kPoint, kLine };

/// How what a pixel covers is sampled: by points of the film, or by lines across the pixel, along which what a
/// pinhole sees is known (curves as well). Nothing where there is a lens, or something moves.
enum class PixelSampling { kPoint, kLine };

struct Mix {
  bool automatic = false;  ///< `auto`: the planner chooses per tile; then strategies is empty
  std::vector<StrategyCount> strategies;
  Combination combination = Combination::kBalance;
  std::optional<double> smooth_width;  ///< kSmooth: scene units; empty means derived from the light
  SmoothShape smooth_shape = SmoothShape::kCubic;  ///< kSmooth
  MediumSampling medium = MediumSampling::kPoint;
  LensSampling lens = LensSampling::kPoint;
  MotionSampling motion = MotionSampling::kPoint;
  PixelSampling pixel = PixelSampling::kPoint;
  bool operator==(const Mix&) const = default;

  int samples() const;  ///< light samples per shading point and light
};

/// Reads the grammar of interface.md: strategy[:count] joined by `+`, then /combination, then
/// /lens=point|line, /medium=point|line, /motion=point|line and /pixel=point|line. InvalidArgument names the word at fault.
absl::StatusOr<Mix> parse_mix(std::string_view text);

/// The normal form: counts and combination always written, lens=line, medium=line, motion=line and
/// pixel=line where it is so. parse_mix(label(m)) == m.
std::string label(const Mix& mix);

/// Labels of a job's mixes; a repeated mix gets `#2`, `#3`, …
std::vector<std::string> labels(const std::vector<Mix>& mixes);

/// The label as a file name: `/` -> `_`, and `:` `@` `=` -> `-`.
std::string file_stem(std::string_view label);

}  // namespace penumbra

#include "worker/textures/nodes.h"

#include <algorithm>
#include <cmath>

#include "proto/status.h"

namespace penumbra {
namespace {

/// A point and the graph to evaluate a node's own values with.
struct Evaluation {
  const std::vector<Node>& nodes;
  const TexturePoint& point;

  Rgb operator()(const RgbValue& value) const {
    return value.texture < 0 ? value.constant : evaluate_node(nodes, value.texture, point);
  }
};

Rgb value_of(const UnusedNode&, const Evaluation&) {
  PENUMBRA_CHECK(!"a texture that was not loaded is evaluated");
  return Rgb(0);
}

Rgb value_of(const ConstantNode& node, const Evaluation&) {
  return node.value;
}

Rgb value_of(const ImageNode& node, const Evaluation& at) {
  const TextureCoordinates c = map(node.mapping, at.point);
  const Rgb value = node.image->lookup(c.st, c.dx, c.dy, node.sampling) * node.scale;
  if (!node.invert) return value;
  return {std::max(0.0f, 1 - value.x), std::max(0.0f, 1 - value.y), std::max(0.0f, 1 - value.z)};
}

Rgb value_of(const ScaleNode& node, const Evaluation& at) {
  return at(node.a) * at(node.b);
}

Rgb value_of(const MixNode& node, const Evaluation& at) {
  const Rgb amount = at(node.amount);
  return at(node.a) * (Rgb(1) - amount) + at(node.b) * amount;
}

Rgb value_of(const BilerpNode& node, const Evaluation& at) {
  const Vec2f st = map(node.mapping, at.point).st;
  return (at(node.v00) * (1 - st.y) + at(node.v01) * st.y) * (1 - st.x) +
         (at(node.v10) * (1 - st.y) + at(node.v11) * st.y) * st.x;
}

Rgb value_of(const UvNode& node, const Evaluation& at) {
  const Vec2f st = map(node.mapping, at.point).st;
  return {st.x - std::floor(st.x), st.y - std::floor(st.y), 0};
}

/// ∫₀ˣ of the square wave that is 0 on [0,1), 1 on [1,2), and so on.
float square_wave_integral(float x) {
  const float half = std::floor(x / 2);
  return half + std::max(0.0f, x - 2 * half - 1);
}

/// Part of [s - width, s + width] on which the square wave is 1.
float odd_fraction(float s, float width) {
  return (square_wave_integral(s + width) - square_wave_integral(s - width)) / (2 * width);
}

Rgb value_of(const Checkerboard2DNode& node, const Evaluation& at) {
  const TextureCoordinates c = map(node.mapping, at.point);
  const float ds = std::max(std::abs(c.dx.x), std::abs(c.dy.x)),
              dt = std::max(std::abs(c.dx.y), std::abs(c.dy.y));
  const Vec2f& st = c.st;
  const bool one_square =
      std::floor(st.x - ds) == std::floor(st.x + ds) && std::floor(st.y - dt) == std::floor(st.y + dt);
  if (!node.filtered || one_square) {
    const bool odd = std::fmod(std::floor(st.x) + std::floor(st.y), 2.0f) != 0;
    return at(odd ? node.odd : node.even);
  }
  // A square is odd where exactly one of the two waves is 1.
  float area = 0.5f;
  if (ds <= 1 && dt <= 1) {
    const float s = ds > 0 ? odd_fraction(st.x, ds) : std::abs(std::fmod(std::floor(st.x), 2.0f));
    const float t = dt > 0 ? odd_fraction(st.y, dt) : std::abs(std::fmod(std::floor(st.y), 2.0f));
    area = s + t - 2 * s * t;
  }
  return at(node.even) * (1 - area) + at(node.odd) * area;
}

Rgb value_of(const Checkerboard3DNode& node, const Evaluation& at) {
  const Vec3f p = at.point.p * node.from_world;
  const bool odd = std::fmod(std::floor(p.x) + std::floor(p.y) + std::floor(p.z), 2.0f) != 0;
  return at(odd ? node.odd : node.even);
}

// In half of the unit cells of st, a dot of radius 0.35 that stays within its cell.
Rgb value_of(const DotsNode& node, const Evaluation& at) {
  const Vec2f st = map(node.mapping, at.point).st;
  const Vec2f cell(std::floor(st.x + 0.5f), std::floor(st.y + 0.5f));
  const auto random = [&](float ds, float dt) { return noise({cell.x + ds, cell.y + dt, 0.5f}); };
  if (random(0.5f, 0.5f) > 0) {
    constexpr float kRadius = 0.35f, kShift = 0.5f - kRadius;
    const Vec2f center(cell.x + kShift * random(1.5f, 2.8f), cell.y + kShift * random(4.5f, 9.8f));
    if ((st - center).length2() < kRadius * kRadius) return at(node.inside);
  }
  return at(node.outside);
}

/// A point and its footprint in the texture's space.
struct Placed {
  Vec3f p, dpdx, dpdy;
};

Placed placed(const Imath::M44f& from_world, const TexturePoint& point) {
  Placed out;
  out.p = point.p * from_world;
  from_world.multDirMatrix(point.dpdx, out.dpdx);
  from_world.multDirMatrix(point.dpdy, out.dpdy);
  return out;
}

float noise_value(const NoiseNode& node, const Placed& at) {
  switch (node.kind) {
    case NoiseKind::kFbm:
      return fbm(at.p, at.dpdx, at.dpdy, node.octaves);
    case NoiseKind::kWrinkled:
      return turbulence(at.p, at.dpdx, at.dpdy, node.octaves);
    case NoiseKind::kWindy: {
      const float strength = fbm(at.p * 0.1f, at.dpdx * 0.1f, at.dpdy * 0.1f, {3, 0.5f});
      return std::abs(strength) * fbm(at.p, at.dpdx, at.dpdy, {6, 0.5f});
    }
  }
  return 0;
}

Rgb value_of(const NoiseNode& node, const Evaluation& at) {
  return Rgb(noise_value(node, placed(node.from_world, at.point)));
}

// Layers along y, disturbed by noise, through a uniform cubic B-spline of pbrt's palette.
Rgb value_of(const MarbleNode& node, const Evaluation& at) {
  static const Rgb kPalette[] = {{.58f, .58f, .6f}, {.58f, .58f, .6f}, {.58f, .58f, .6f},
                                 {.5f, .5f, .5f},   {.6f, .59f, .58f}, {.58f, .58f, .6f},
                                 {.58f, .58f, .6f}, {.2f, .2f, .33f},  {.58f, .58f, .6f}};
  constexpr int kSegments = static_cast<int>(std::size(kPalette)) - 3;
  const Placed p = placed(node.from_world, at.point);
  const float wave = node.scale * p.p.y + node.variation * fbm(p.p * node.scale, p.dpdx * node.scale,
                                                               p.dpdy * node.scale, node.octaves);
  const float x = (0.5f + 0.5f * std::sin(wave)) * kSegments;
  const int i = std::clamp(static_cast<int>(x), 0, kSegments - 1);
  const float t = x - i, r = 1 - t;
  const Rgb sum = kPalette[i] * (r * r * r) + kPalette[i + 1] * (3 * t * t * t - 6 * t * t + 4) +
                  kPalette[i + 2] * (3 * r * r * r - 6 * r * r + 4) + kPalette[i + 3] * (t * t * t);
  return sum * (1.5f / 6);  // pbrt brightens the palette by half
}

}  // namespace

Rgb evaluate_node(const std::vector<Node>& nodes, int index, const TexturePoint& point) {
  const Evaluation at{nodes, point};
  return std::visit([&](const auto& node) { return value_of(node, at); }, nodes[index]);
}

}  // namespace penumbra

#pragma once
// The closed set of textures, as a graph: a node's values may be textures that come before it. Float and
// spectrum textures are one: a float texture's node is grey.
//
// A new texture needs its struct and its name here, an overload of value_of() in nodes.cpp, a builder in
// node_builder.cpp.
#include <memory>
#include <variant>
#include <vector>

#include "worker/textures/image.h"
#include "worker/textures/mapping.h"
#include "worker/textures/noise.h"
#include "worker/textures/textures.h"

namespace penumbra {

/// Not loaded because nothing uses it. Evaluating it is a programmer's fault.
struct UnusedNode {};

struct ConstantNode {
  Rgb value;
};
struct ImageNode {
  std::shared_ptr<const Image> image;
  Mapping2D mapping;
  ImageSampling sampling;
  float scale = 1;
  bool invert = false;  ///< 1 - value, after the scale, not below 0
};
struct ScaleNode {
  RgbValue a, b;
};
/// (1 - amount) a + amount b.
struct MixNode {
  RgbValue a, b, amount;
};
/// Bilinear between the corners of the unit square of st; v10 is at s = 1, t = 0.
struct BilerpNode {
  Mapping2D mapping;
  RgbValue v00, v01, v10, v11;
};
/// Red and green are the fractions of st.
struct UvNode {
  Mapping2D mapping;
};
struct Checkerboard2DNode {
  Mapping2D mapping;
  RgbValue even, odd;
  bool filtered = true;  ///< box filter in closed form
};
struct Checkerboard3DNode {
  Imath::M44f from_world;
  RgbValue even, odd;
};
struct DotsNode {
  Mapping2D mapping;
  RgbValue inside, outside;
};
enum class NoiseKind { kFbm, kWrinkled, kWindy };
struct NoiseNode {
  NoiseKind kind = NoiseKind::kFbm;
  Imath::M44f from_world;
  Octaves octaves;
};
struct MarbleNode {
  Imath::M44f from_world;
  Octaves octaves;
  float scale = 1, variation = 0.2f;
};

using Node = std::variant<UnusedNode, ConstantNode, ImageNode, ScaleNode, MixNode, BilerpNode, UvNode,
                          Checkerboard2DNode, Checkerboard3DNode, DotsNode, NoiseNode, MarbleNode>;

/// Value of nodes[index] at a point.
Rgb evaluate_node(const std::vector<Node>& nodes, int index, const TexturePoint& point);

}  // namespace penumbra

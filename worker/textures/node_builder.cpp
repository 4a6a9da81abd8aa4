#include "worker/textures/node_builder.h"

#include <algorithm>

#include "proto/status.h"
#include "scenes/substitutes.h"

namespace penumbra {
namespace {

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

float number(const Params& params, std::string_view name, float fallback) {
  return static_cast<float>(params.number(name, fallback));
}

/// v4: "encoding" "sRGB" | "linear" | "gamma X"; v3: "gamma" true | false.
absl::StatusOr<Encoding> encoding_of(const Params& params, const SceneDescription& description) {
  if (const Param* param = params.find("encoding")) {
    const std::string text = params.string("encoding", "");
    if (text == "sRGB") return Encoding{Encoding::kSrgb};
    if (text == "linear") return Encoding{Encoding::kLinear};
    if (text.starts_with("gamma ")) {
      const float gamma = std::strtof(text.c_str() + 6, nullptr);
      if (gamma > 0) return Encoding{Encoding::kGamma, gamma};
    }
    return invalid_input("{}: unknown encoding '{}'", description.place(param->loc), text);
  }
  if (params.find("gamma") == nullptr) return Encoding{};
  return Encoding{params.boolean("gamma", true) ? Encoding::kSrgb : Encoding::kLinear};
}

absl::StatusOr<ImageSampling> sampling_of(const Params& params, const SceneDescription& description) {
  ImageSampling sampling;
  const std::string wrap = params.string("wrap", "repeat");
  if (wrap == "clamp") {
    sampling.wrap = Wrap::kClamp;
  } else if (wrap == "black") {
    sampling.wrap = Wrap::kBlack;
  } else if (wrap != "repeat") {
    return invalid_input("{}: unknown wrap mode '{}'", description.place(params.find("wrap")->loc), wrap);
  }
  const std::string filter =
      params.string("filter", params.boolean("trilinear", false) ? "trilinear" : "ewa");
  if (is_one_of(filter, {"ewa", "EWA"})) {
    sampling.filter = Filter::kEwa;
  } else if (filter == "trilinear") {
    sampling.filter = Filter::kTrilinear;
  } else if (filter == "bilinear") {
    sampling.filter = Filter::kBilinear;
  } else if (filter == "point") {
    sampling.filter = Filter::kPoint;
  } else {
    return invalid_input("{}: unknown texture filter '{}'", description.place(params.find("filter")->loc),
                         filter);
  }
  sampling.max_anisotropy = number(params, "maxanisotropy", 8);
  if (!(sampling.max_anisotropy >= 1 && sampling.max_anisotropy <= 1024)) {
    return invalid_input("{}: maxanisotropy must be in [1, 1024]",
                         description.place(params.find("maxanisotropy")->loc));
  }
  return sampling;
}

Octaves octaves_of(const Params& params) {
  return {static_cast<int>(std::clamp<int64_t>(params.integer("octaves", 8), 0, 64)),
          number(params, "roughness", 0.5f)};
}

}  // namespace

absl::Status NodeBuilder::complain(std::string message) {
  if (strict_) return absl::InvalidArgumentError(message);
  warnings_.push_back(std::move(message));
  return absl::OkStatus();
}

absl::StatusOr<RgbValue> NodeBuilder::value(const TextureEntity& entity, std::string_view name,
                                            float fallback) const {
  return rgb_value(entity.params, name, Rgb(fallback), description_, files_);
}

absl::StatusOr<std::shared_ptr<const Image>> NodeBuilder::image(const std::string& path, bool grey,
                                                                const Encoding& encoding) {
  std::shared_ptr<const Image>& shared = images_[{path, grey, encoding.kind, encoding.gamma}];
  if (shared == nullptr) {
    absl::StatusOr<Texels> texels = read_image(path, grey, encoding);
    if (!texels.ok()) return texels.status();
    shared = std::make_shared<const Image>(*std::move(texels));
  }
  return shared;
}

absl::StatusOr<Node> NodeBuilder::build_image(const TextureEntity& entity) {
  ImageNode node;
  ASSIGN_OR_RETURN(const Encoding encoding, encoding_of(entity.params, description_));
  ASSIGN_OR_RETURN(node.sampling, sampling_of(entity.params, description_));
  ASSIGN_OR_RETURN(node.mapping, make_mapping(entity, description_));
  node.scale = number(entity.params, "scale", 1);
  node.invert = entity.params.boolean("invert", false);
  const std::string name = entity.params.string("filename", "");
  const absl::StatusOr<std::string> path = files_.path_of(name);
  absl::Status status = path.status();
  if (path.ok()) {
    auto loaded = image(*path, entity.is_float, encoding);
    if (loaded.ok()) {
      node.image = *std::move(loaded);
      return node;
    }
    status = loaded.status();
  }
  // As pbrt-v3: the texture is 1 everywhere, times its scale.
  RETURN_IF_ERROR(complain(missing_text(entity, message_of(status), description_)));
  return ConstantNode{Rgb(node.scale)};
}

absl::StatusOr<Node> NodeBuilder::build_checkerboard(const TextureEntity& entity) {
  ASSIGN_OR_RETURN(const RgbValue even, value(entity, "tex1", 1));
  ASSIGN_OR_RETURN(const RgbValue odd, value(entity, "tex2", 0));
  if (entity.params.integer("dimension", 2) == 3) {
    return Checkerboard3DNode{Imath::M44f(entity.placement.start), even, odd};
  }
  ASSIGN_OR_RETURN(const Mapping2D mapping, make_mapping(entity, description_));
  return Checkerboard2DNode{mapping, even, odd, entity.params.string("aamode", "closedform") != "none"};
}

// pbrt-v3 multiplies points by the texture's own transform (not its inverse): a scale of 5 makes detail
// five times finer. Scenes are written for that.
absl::StatusOr<Node> NodeBuilder::build_noise(const TextureEntity& entity) {
  const Imath::M44f from_world(entity.placement.start);
  const Octaves octaves = octaves_of(entity.params);
  if (entity.type == "marble") {
    return MarbleNode{from_world, octaves, number(entity.params, "scale", 1),
                      number(entity.params, "variation", 0.2f)};
  }
  if (entity.type == "wrinkled") return NoiseNode{NoiseKind::kWrinkled, from_world, octaves};
  if (entity.type == "windy") return NoiseNode{NoiseKind::kWindy, from_world, octaves};
  return NoiseNode{NoiseKind::kFbm, from_world, octaves};
}

absl::StatusOr<Node> NodeBuilder::build_with_mapping(const TextureEntity& entity) {
  ASSIGN_OR_RETURN(const Mapping2D mapping, make_mapping(entity, description_));
  if (entity.type == "uv") return UvNode{mapping};
  if (entity.type == "dots") {
    ASSIGN_OR_RETURN(const RgbValue inside, value(entity, "inside", 1));
    ASSIGN_OR_RETURN(const RgbValue outside, value(entity, "outside", 0));
    return DotsNode{mapping, inside, outside};
  }
  ASSIGN_OR_RETURN(const RgbValue v00, value(entity, "v00", 0));
  ASSIGN_OR_RETURN(const RgbValue v01, value(entity, "v01", 1));
  ASSIGN_OR_RETURN(const RgbValue v10, value(entity, "v10", 0));
  ASSIGN_OR_RETURN(const RgbValue v11, value(entity, "v11", 1));
  return BilerpNode{mapping, v00, v01, v10, v11};
}

absl::StatusOr<Node> NodeBuilder::build(const TextureEntity& entity) {
  const std::string& type = entity.type;
  if (type == "imagemap") return build_image(entity);
  if (type == "constant") {
    ASSIGN_OR_RETURN(const RgbValue constant, value(entity, "value", 1));
    return ConstantNode{constant.constant};
  }
  if (type == "scale") {  // v3: tex1 tex2; v4: tex scale
    ASSIGN_OR_RETURN(const RgbValue a, value(entity, entity.params.find("tex") ? "tex" : "tex1", 1));
    ASSIGN_OR_RETURN(const RgbValue b, value(entity, entity.params.find("scale") ? "scale" : "tex2", 1));
    return ScaleNode{a, b};
  }
  if (type == "mix") {
    ASSIGN_OR_RETURN(const RgbValue a, value(entity, "tex1", 0));
    ASSIGN_OR_RETURN(const RgbValue b, value(entity, "tex2", 1));
    ASSIGN_OR_RETURN(const RgbValue amount, value(entity, "amount", 0.5f));
    return MixNode{a, b, amount};
  }
  if (type == "checkerboard") return build_checkerboard(entity);
  if (is_one_of(type, {"uv", "dots", "bilerp"})) return build_with_mapping(entity);
  if (is_one_of(type, {"fbm", "wrinkled", "windy", "marble"})) return build_noise(entity);
  if (is_one_of(type, {"ptex", "directionmix"})) {
    RETURN_IF_ERROR(complain(fmt::format("{}: texture '{}' of type '{}' is not supported: constant 1 instead",
                                         place(entity), entity.name, type)));
    return ConstantNode{Rgb(1)};
  }
  return invalid_input("{}: unknown texture type '{}'", place(entity), type);
}

}  // namespace penumbra

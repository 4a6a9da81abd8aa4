#include "worker/textures/textures.h"

#include "proto/status.h"
#include "worker/textures/node_builder.h"
#include "worker/textures/nodes.h"

namespace penumbra {
namespace {

/// Lookups that one evaluation of a texture may cost, its own textures included.
constexpr int64_t kMostLookups = 4096;

/// Marks what the marked textures refer to. A texture refers only to earlier ones, so one pass backwards.
absl::StatusOr<std::vector<bool>> closure(const SceneDescription& description, std::vector<bool> used) {
  used.resize(description.textures.size());
  for (size_t i = used.size(); i-- > 0;) {
    if (!used[i]) continue;
    for (const Param& param : description.textures[i].params.all) {
      if (param.type != "texture" || param.texture < 0) continue;
      if (static_cast<size_t>(param.texture) >= i) {
        return invalid_input("{}: texture '{}' refers to itself or to a later texture",
                             description.place(param.loc), description.textures[i].name);
      }
      used[param.texture] = true;
    }
  }
  return used;
}

/// A texture that names another twice, which names another twice, …, costs 2ⁿ: refused while it is cheap.
absl::Status check_cost(const SceneDescription& description, const std::vector<bool>& used) {
  std::vector<int64_t> lookups(used.size(), 1);
  for (size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    for (const Param& param : description.textures[i].params.all) {
      if (param.type == "texture" && param.texture >= 0) lookups[i] += lookups[param.texture];
    }
    if (lookups[i] > kMostLookups) {
      return invalid_input("{}: texture '{}' needs more than {} lookups, its own textures included",
                           description.place(description.textures[i].loc), description.textures[i].name,
                           kMostLookups);
    }
  }
  return absl::OkStatus();
}

}  // namespace

struct Textures::Parts {
  std::vector<Node> nodes;  ///< parallel to the description's textures
};

Textures::Textures() : parts_(std::make_unique<Parts>()) {}
Textures::Textures(Textures&&) noexcept = default;
Textures& Textures::operator=(Textures&&) noexcept = default;
Textures::~Textures() = default;

absl::StatusOr<Textures> Textures::build(const SceneDescription& description, const SceneFiles& files,
                                         const std::vector<bool>& used, bool strict,
                                         std::vector<std::string>& warnings) {
  ASSIGN_OR_RETURN(const std::vector<bool> needed, closure(description, used));
  RETURN_IF_ERROR(check_cost(description, needed));
  Textures textures;
  textures.parts_->nodes.resize(needed.size());
  NodeBuilder builder(description, files, strict, warnings);
  for (size_t i = 0; i < needed.size(); ++i) {
    if (!needed[i]) continue;
    ASSIGN_OR_RETURN(textures.parts_->nodes[i], builder.build(description.textures[i]));
  }
  return textures;
}

float Textures::evaluate(const FloatValue& value, const SurfacePoint& point) const {
  if (value.texture < 0) return value.constant;
  return evaluate_node(parts_->nodes, value.texture, TexturePoint(point)).x;
}

Rgb Textures::evaluate(const RgbValue& value, const SurfacePoint& point) const {
  if (value.texture < 0) return value.constant;
  return evaluate_node(parts_->nodes, value.texture, TexturePoint(point));
}

float Textures::evaluate(const FloatValue& value, const Vec2f& uv, const Vec3f& p) const {
  if (value.texture < 0) return value.constant;
  return evaluate_node(parts_->nodes, value.texture, TexturePoint(uv, p)).x;
}

}  // namespace penumbra

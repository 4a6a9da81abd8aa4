#include "scenes/scene_builder.h"

#include <algorithm>
#include <optional>

#include "scenes/film_size.h"
#include "scenes/transforms.h"

namespace penumbra {
namespace {

// Deeper than any exporter writes; the stacks live on the heap, so this only bounds memory.
constexpr size_t kDeepestNesting = 100'000;

}  // namespace

// ---- transforms ----

absl::Status SceneBuilder::set_transform(const Matrix& m, FileLoc loc) {
  if (!is_finite(m)) return diagnostics_.error(loc, "the current transform is no longer finite");
  if (transforms_.start_active) transforms_.ctm.start = m;
  if (transforms_.end_active) transforms_.ctm.end = m;
  return absl::OkStatus();
}

absl::Status SceneBuilder::concatenate(const Matrix& m, FileLoc loc) {
  Placement& ctm = transforms_.ctm;
  const bool moving = ctm.moving();
  if (transforms_.start_active) ctm.start = m * ctm.start;
  if (transforms_.end_active) ctm.end = transforms_.start_active && !moving ? ctm.start : m * ctm.end;
  if (!is_finite(ctm.start) || !is_finite(ctm.end))
    return diagnostics_.error(loc, "the current transform is no longer finite");
  return absl::OkStatus();
}

void SceneBuilder::name_coordinate_system(const std::string& name) {
  coordinate_systems_[name] = transforms_.ctm;
}

void SceneBuilder::use_coordinate_system(const std::string& name, FileLoc loc) {
  if (const auto known = coordinate_systems_.find(name); known != coordinate_systems_.end())
    transforms_.ctm = known->second;
  else
    diagnostics_.warn(loc, "no coordinate system '{}': the transform stays", printable(name));
}

absl::Status SceneBuilder::choose_active_transforms(std::string_view which, FileLoc loc) {
  if (which != "All" && which != "StartTime" && which != "EndTime")
    return diagnostics_.error(loc, "ActiveTransform takes All, StartTime or EndTime, not '{}'",
                              printable(which));
  transforms_.start_active = which != "EndTime";
  transforms_.end_active = which != "StartTime";
  return absl::OkStatus();
}

absl::Status SceneBuilder::set_transform_times(double start, double end, FileLoc loc) {
  if (!(start < end)) return diagnostics_.error(loc, "TransformTimes: {} is not before {}", start, end);
  description_.transform_start_time = start;
  description_.transform_end_time = end;
  return absl::OkStatus();
}

namespace {

absl::StatusOr<Matrix> invertible(const std::optional<Matrix>& m, std::string_view what, FileLoc loc,
                                  const Diagnostics& diagnostics) {
  if (!m)
    return diagnostics.error(loc, "this {}'s transform is not affine (its last column is not 0 0 0 1)", what);
  if (is_singular(*m)) return diagnostics.error(loc, "this {}'s transform is singular", what);
  return *m;
}

/// The placement with `part` taken of each end's matrix.
template <class Part>
absl::StatusOr<Placement> checked(const Placement& ctm, Part&& part, std::string_view what, FileLoc loc,
                                  const Diagnostics& diagnostics) {
  Placement placement;
  ASSIGN_OR_RETURN(placement.start, invertible(part(ctm.start), what, loc, diagnostics));
  placement.end = placement.start;
  if (ctm.moving()) {
    ASSIGN_OR_RETURN(placement.end, invertible(part(ctm.end), what, loc, diagnostics));
  }
  return placement;
}

}  // namespace

absl::StatusOr<Placement> SceneBuilder::placement(std::string_view what, FileLoc loc) const {
  return checked(transforms_.ctm, as_affine, what, loc, diagnostics_);
}

absl::StatusOr<Placement> SceneBuilder::placement_at_infinity(std::string_view what, FileLoc loc) const {
  const auto linear = [](const Matrix& m) { return std::optional(linear_part(m)); };
  return checked(transforms_.ctm, linear, what, loc, diagnostics_);
}

// ---- the render's options ----

absl::Status SceneBuilder::check_name(PluginKind kind, const Entity& entity) {
  if (support_of(kind, entity.type) != Support::kUnknown) return absl::OkStatus();
  if (kind == PluginKind::kShape || kind == PluginKind::kLight || kind == PluginKind::kAreaLight)
    return diagnostics_.error(entity.loc, "unknown {} '{}'", noun(kind), printable(entity.type));
  diagnostics_.warn(entity.loc, "unknown {} '{}'", noun(kind), printable(entity.type));
  return absl::OkStatus();
}

absl::Status SceneBuilder::set_option(PluginKind kind, Entity entity) {
  RETURN_IF_ERROR(check_name(kind, entity));
  if (kind == PluginKind::kFilm) RETURN_IF_ERROR(check_film(entity, diagnostics_));
  switch (kind) {
    case PluginKind::kFilm:
      description_.film = std::move(entity);
      break;
    case PluginKind::kSampler:
      description_.sampler = std::move(entity);
      break;
    case PluginKind::kFilter:
      description_.filter = std::move(entity);
      break;
    case PluginKind::kIntegrator:
      description_.integrator = std::move(entity);
      break;
    case PluginKind::kAccelerator:
      description_.accelerator = std::move(entity);
      break;
    default:
      PENUMBRA_CHECK(false);
  }
  return absl::OkStatus();
}

absl::Status SceneBuilder::set_camera(Entity entity) {
  RETURN_IF_ERROR(check_name(PluginKind::kCamera, entity));
  ASSIGN_OR_RETURN(description_.camera_placement, placement("camera", entity.loc));
  const Placement& to_camera = description_.camera_placement;
  coordinate_systems_["camera"] = {to_camera.start.inverse(), to_camera.end.inverse()};
  description_.camera_medium = state_.outside_medium;
  description_.camera = std::move(entity);
  return absl::OkStatus();
}

// ---- stacks ----

void SceneBuilder::push_state() {
  saved_.push_back({state_, float_textures_.mark(), spectrum_textures_.mark(), materials_.mark()});
  saved_transforms_.push_back(transforms_);
}

void SceneBuilder::pop_state() {
  const SavedState& saved = saved_.back();
  float_textures_.undo_to(saved.float_textures);
  spectrum_textures_.undo_to(saved.spectrum_textures);
  materials_.undo_to(saved.materials);
  state_ = saved.state;
  saved_.pop_back();
  const size_t floor = imports_.empty() ? 0 : imports_.back().transforms;
  if (saved_transforms_.size() <= floor) return;  // an unmatched TransformEnd took it
  transforms_ = saved_transforms_.back();
  saved_transforms_.pop_back();
}

absl::Status SceneBuilder::begin_attributes(FileLoc loc) {
  if (saved_transforms_.size() >= kDeepestNesting)
    return diagnostics_.error(loc, "nested more than {} deep", kDeepestNesting);
  push_state();
  return absl::OkStatus();
}

void SceneBuilder::end_attributes(FileLoc loc) {
  // One stack for attributes and objects: real files interleave ObjectEnd and AttributeEnd.
  const size_t floor = imports_.empty() ? 0 : imports_.back().saved;
  if (saved_.size() <= floor)
    diagnostics_.warn(loc, "AttributeEnd without its AttributeBegin: ignored");
  else
    pop_state();
}

absl::Status SceneBuilder::begin_transform(FileLoc loc) {
  if (saved_transforms_.size() >= kDeepestNesting)
    return diagnostics_.error(loc, "nested more than {} deep", kDeepestNesting);
  saved_transforms_.push_back(transforms_);
  return absl::OkStatus();
}

void SceneBuilder::end_transform(FileLoc loc) {
  const size_t floor = imports_.empty() ? 0 : imports_.back().transforms;
  if (saved_transforms_.size() <= floor) {
    diagnostics_.warn(loc, "TransformEnd without its TransformBegin: ignored");
    return;
  }
  transforms_ = saved_transforms_.back();
  saved_transforms_.pop_back();
}

void SceneBuilder::begin_import() {
  push_state();
  imports_.push_back({saved_.size(), saved_transforms_.size()});
}

void SceneBuilder::end_import() {
  const ImportMark mark = imports_.back();
  imports_.pop_back();
  while (saved_.size() > mark.saved) pop_state();
  saved_transforms_.resize(std::min(saved_transforms_.size(), mark.transforms));
  pop_state();
}

// ---- state ----

absl::Status SceneBuilder::add_defaults(const std::string& target, Params params, FileLoc loc) {
  static constexpr std::string_view kTargets[] = {"shape", "light", "material", "medium", "texture"};
  if (std::find(std::begin(kTargets), std::end(kTargets), target) == std::end(kTargets))
    return diagnostics_.error(loc,
                              "Attribute: unknown target '{}'; there are shape, light, material, medium, "
                              "texture",
                              printable(target));
  auto defaults = state_.defaults ? *state_.defaults : std::map<std::string, std::vector<Param>>();
  std::vector<Param>& list = defaults[target];
  std::move(params.all.begin(), params.all.end(), std::back_inserter(list));
  state_.defaults = std::make_shared<const std::map<std::string, std::vector<Param>>>(std::move(defaults));
  return absl::OkStatus();
}

void SceneBuilder::prepend_defaults(const std::string& target, Params& params) const {
  if (!state_.defaults) return;
  const auto defaults = state_.defaults->find(target);
  if (defaults == state_.defaults->end()) return;
  // Before the entity's own: of a name given twice the last wins.
  params.all.insert(params.all.begin(), defaults->second.begin(), defaults->second.end());
}

void SceneBuilder::set_media(const std::string& inside, const std::string& outside) {
  state_.inside_medium = inside;
  state_.outside_medium = outside;
}

void SceneBuilder::name_medium(const std::string& name, Params params, FileLoc loc) {
  prepend_defaults("medium", params);
  MediumEntity medium;
  medium.type = params.string("type", "");
  medium.params = std::move(params);
  medium.loc = loc;
  medium.name = name;
  medium.placement = transforms_.ctm;
  static_cast<void>(check_name(PluginKind::kMedium, medium));  // only warns
  description_.media.push_back(std::move(medium));
}

}  // namespace penumbra

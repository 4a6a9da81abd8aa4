#pragma once
// The meaning of pbrt's directives: a current transform and graphics state on stacks, and the description
// that grows. Knows no syntax; parser.cpp feeds it one directive at a time.
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "scenes/diagnostics.h"
#include "scenes/pbrt_names.h"
#include "scenes/scoped_names.h"

namespace penumbra {

class SceneBuilder {
 public:
  explicit SceneBuilder(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  absl::Status error(FileLoc loc, std::string_view what) const { return diagnostics_.error(loc, "{}", what); }
  void warn(FileLoc loc, std::string_view what) { diagnostics_.warn(loc, "{}", what); }

  // Transforms.
  absl::Status concatenate(const Matrix& m, FileLoc loc);
  absl::Status set_transform(const Matrix& m, FileLoc loc);
  void name_coordinate_system(const std::string& name);
  void use_coordinate_system(const std::string& name, FileLoc loc);
  absl::Status choose_active_transforms(std::string_view which, FileLoc loc);
  absl::Status set_transform_times(double start, double end, FileLoc loc);

  // The render's options.
  absl::Status set_option(PluginKind kind, Entity entity);
  absl::Status set_camera(Entity entity);

  // State.
  absl::Status begin_attributes(FileLoc loc);
  void end_attributes(FileLoc loc);
  absl::Status begin_transform(FileLoc loc);
  void end_transform(FileLoc loc);
  void reverse_orientation() { state_.reverse_orientation = !state_.reverse_orientation; }
  absl::Status add_defaults(const std::string& target, Params params, FileLoc loc);
  void set_material(Entity entity);
  absl::Status name_material(const std::string& name, Params params, FileLoc loc);
  void use_material(const std::string& name, FileLoc loc);
  void name_medium(const std::string& name, Params params, FileLoc loc);
  void set_media(const std::string& inside, const std::string& outside);
  absl::Status add_texture(const std::string& name, const std::string& value_type, Entity entity);

  // The world.
  void begin_world(FileLoc loc);
  void end_world(FileLoc loc);
  bool in_world() const { return phase_ == Phase::kWorld; }
  bool after_world() const { return phase_ == Phase::kAfterWorld; }
  absl::Status add_light(Entity entity);
  absl::Status set_area_light(Entity entity);
  absl::Status add_shape(Entity entity);
  absl::Status begin_object(const std::string& name, FileLoc loc);
  absl::Status end_object(FileLoc loc);
  absl::Status add_instance(const std::string& name, FileLoc loc);

  /// v4's Import: what changes until end_import() stays inside.
  void begin_import();
  void end_import();

  /// Resolves the names that were used before their definition. The builder is spent afterwards.
  SceneDescription finish(FileLoc end);

 private:
  enum class Phase { kOptions, kWorld, kAfterWorld };

  /// What AttributeBegin saves, beside the transforms.
  struct State {
    int material = -1;  ///< as in ShapeEntity; below -1: forward_materials_[-2 - material]
    int area_light = -1;
    bool reverse_orientation = false;
    std::string inside_medium, outside_medium;
    /// v4's Attribute: parameters that entities of a kind start with. Shared: states are many.
    std::shared_ptr<const std::map<std::string, std::vector<Param>>> defaults;
  };
  struct Transforms {
    Placement ctm;
    bool start_active = true, end_active = true;
  };
  struct SavedState {
    State state;
    size_t float_textures, spectrum_textures, materials;  ///< marks in the scoped names
  };
  struct ForwardName {
    std::string name;
    FileLoc loc;
  };
  struct ImportMark {
    size_t saved, transforms;
  };

  absl::Status check_name(PluginKind kind, const Entity& entity);
  /// The current transform, affine and invertible, for something that is placed in the world.
  absl::StatusOr<Placement> placement(std::string_view what, FileLoc loc) const;
  /// The same for something at infinity: of its transform only the linear part acts.
  absl::StatusOr<Placement> placement_at_infinity(std::string_view what, FileLoc loc) const;
  void push_state();
  void pop_state();
  void prepend_defaults(const std::string& target, Params& params) const;
  void resolve_textures(const std::string& owner, Params& params);
  void resolve_texture(const std::string& owner, Param& param);
  int find_texture(const std::string& owner, const Param& param) const;
  void resolve_forward_materials();
  void resolve_forward_instances();
  void warn_about_missing_textures();

  Diagnostics& diagnostics_;
  SceneDescription description_;
  Phase phase_ = Phase::kOptions;
  State state_;
  Transforms transforms_;
  std::vector<SavedState> saved_;
  std::vector<Transforms> saved_transforms_;
  std::vector<ImportMark> imports_;
  std::unordered_map<std::string, Placement> coordinate_systems_;
  ScopedNames float_textures_, spectrum_textures_, materials_;
  std::unordered_map<std::string, int> objects_;
  std::vector<ForwardName> forward_materials_;
  std::vector<ForwardName> forward_instances_;  ///< InstanceEntity::object = -2 - index
  int open_object_ = -1;
  FileLoc open_object_loc_;
};

}  // namespace penumbra

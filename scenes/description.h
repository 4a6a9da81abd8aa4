#pragma once
// A scene as it was written: pure data, every entity with its place in the text. Knows no Embree, no
// renderer, loads no mesh and no image. Made by parser.h, read by everything else.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scenes/math.h"

namespace penumbra {

/// A place in a scene file; line and column count from 1. file indexes SceneDescription::files.
struct FileLoc {
  uint32_t file = 0, line = 0, column = 0;
};

/// One `"type name" values` of a directive.
struct Param {
  std::string type;  ///< normalised: float integer bool string point2 point3 vector2 vector3 normal rgb
                     ///< blackbody spectrum xyz texture
  std::string name;
  FileLoc loc;
  std::vector<double> numbers;       ///< float, integer, point…, rgb, xyz, blackbody, spectrum samples
  std::vector<std::string> strings;  ///< string, texture, spectrum name or file
  std::vector<uint8_t> bools;
  int texture = -1;  ///< type texture: index into SceneDescription::textures; -1: no such name
};

/// The parameters of one directive. Of a name given twice the last wins (pbrt-v3).
class Params {
 public:
  std::vector<Param> all;

  const Param* find(std::string_view name) const;
  /// First value, or the fallback where the parameter is absent or of another type.
  double number(std::string_view name, double fallback) const;
  int64_t integer(std::string_view name, int64_t fallback) const;
  bool boolean(std::string_view name, bool fallback) const;
  std::string string(std::string_view name, std::string_view fallback) const;
};

/// A thing with a plugin name and parameters: camera, film, sampler, integrator, …
struct Entity {
  std::string type;
  Params params;
  FileLoc loc;
};

/// Object-to-world at shutter open and close; they differ only where the scene moves.
struct Placement {
  Matrix start, end;
  bool moving() const { return start != end; }
};

struct TextureEntity : Entity {
  std::string name;
  bool is_float = false;  ///< else spectrum; the two have separate names
  Placement placement;
};

struct MaterialEntity : Entity {
  std::string name;  ///< empty for an unnamed `Material`
};

struct LightEntity : Entity {
  Placement placement;
};

struct MediumEntity : Entity {
  std::string name;
  Placement placement;
};

struct ShapeEntity : Entity {
  Placement placement;
  bool reverse_orientation = false;
  int material = -1;    ///< index into materials; -1: pbrt's default (matte, 0.5)
  int area_light = -1;  ///< index into area_lights
  std::string inside_medium, outside_medium;
};

/// ObjectBegin … ObjectEnd: shapes by index range into SceneDescription::object_shapes.
struct ObjectEntity {
  std::string name;
  FileLoc loc;
  std::vector<ShapeEntity> shapes;
};

struct InstanceEntity {
  int object = -1;  ///< index into objects
  Placement placement;
  FileLoc loc;
};

struct SceneDescription {
  bool has_world = false;  ///< WorldBegin was there: without it the text is a fragment, not a picture
  std::vector<std::string> files;  ///< as named by the text; [0] is the main file

  Entity camera, film, sampler, filter, integrator, accelerator;  ///< type empty: not given
  Placement camera_placement;                                     ///< world-to-camera (pbrt's CTM)
  std::string camera_medium;
  double transform_start_time = 0, transform_end_time = 1;

  std::vector<TextureEntity> textures;
  std::vector<MaterialEntity> materials;
  std::vector<LightEntity> lights;
  std::vector<Entity> area_lights;
  std::vector<MediumEntity> media;
  std::vector<ShapeEntity> shapes;
  std::vector<ObjectEntity> objects;
  std::vector<InstanceEntity> instances;

  std::vector<std::string> warnings;  ///< `file:line:column: …`

  /// `kitchen.pbrt:41:7`
  std::string place(FileLoc loc) const;
};

}  // namespace penumbra

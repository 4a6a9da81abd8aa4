#include "scenes/ply.h"

#include <bit>
#include <charconv>
#include <cstring>

#include "proto/status.h"
#include "scenes/diagnostics.h"
#include "scenes/lexer.h"
#include "scenes/ply_header.h"
#include "scenes/read_file.h"

namespace penumbra {
namespace {

static_assert(std::endian::native == std::endian::little);

/// Reads value after value of a binary body. read() is false at the end of the bytes.
template <bool big_endian>
class BinaryCursor {
 public:
  explicit BinaryCursor(std::string_view bytes) : at_(bytes.data()), end_(at_ + bytes.size()) {}

  bool read(PlyType type, double& value) {
    switch (type) {
      case PlyType::kInt8:
        return get<int8_t>(value);
      case PlyType::kUint8:
        return get<uint8_t>(value);
      case PlyType::kInt16:
        return get<int16_t>(value);
      case PlyType::kUint16:
        return get<uint16_t>(value);
      case PlyType::kInt32:
        return get<int32_t>(value);
      case PlyType::kUint32:
        return get<uint32_t>(value);
      case PlyType::kFloat32:
        return get<float>(value);
      case PlyType::kFloat64:
        return get<double>(value);
    }
    return false;
  }
  bool skip(PlyType type, uint64_t count) {
    if (count > static_cast<uint64_t>(end_ - at_) / size_of(type)) return false;
    at_ += count * size_of(type);
    return true;
  }
  uint64_t rest() const { return static_cast<uint64_t>(end_ - at_); }

 private:
  template <class T>
  bool get(double& value) {
    if (static_cast<size_t>(end_ - at_) < sizeof(T)) return false;
    char raw[sizeof(T)];
    for (size_t i = 0; i < sizeof(T); ++i) raw[i] = at_[big_endian ? sizeof(T) - 1 - i : i];
    T t;
    std::memcpy(&t, raw, sizeof(T));
    at_ += sizeof(T);
    value = static_cast<double>(t);
    return true;
  }
  const char* at_;
  const char* end_;
};

/// The same for text. read() is false for what is no number, too.
class AsciiCursor {
 public:
  explicit AsciiCursor(std::string_view text) : text_(text) {}

  bool read(PlyType, double& value) {
    skip_blanks();
    const std::string_view word = text_.substr(0, text_.find_first_of(kBlanks));
    const auto number = parse_number(word);
    if (!number) return false;
    value = *number;
    text_.remove_prefix(word.size());
    return true;
  }
  bool skip(PlyType type, uint64_t count) {
    double ignored;
    for (uint64_t i = 0; i < count; ++i)
      if (!read(type, ignored)) return false;
    return true;
  }
  uint64_t rest() {
    skip_blanks();
    return text_.size();
  }

 private:
  static constexpr std::string_view kBlanks = " \t\r\n\v\f";
  void skip_blanks() { text_.remove_prefix(std::min(text_.find_first_not_of(kBlanks), text_.size())); }
  std::string_view text_;
};

absl::Status broken(const PlyElement& element, uint64_t row) {
  return invalid_input("the PLY file ends, or is no longer numbers, in {} {} of {}", printable(element.name),
                       row, element.count);
}

/// Whether a list of so many items may follow: an item has a byte at least. A count in text is any number,
/// and one beyond an integer's range must not become an integer.
template <class Cursor>
bool may_follow(Cursor& cursor, double count) {
  return count >= 0 && count <= static_cast<double>(cursor.rest());
}

template <class Cursor>
bool skip_property(Cursor& cursor, const PlyProperty& property) {
  if (!property.is_list) return cursor.skip(property.type, 1);
  double count = 0;
  return cursor.read(property.count_type, count) && may_follow(cursor, count) &&
         cursor.skip(property.type, static_cast<uint64_t>(count));
}

template <class Cursor>
absl::Status skip_element(Cursor& cursor, const PlyElement& element) {
  if (element.properties.empty()) return absl::OkStatus();  // rows of nothing, however many
  for (uint64_t row = 0; row < element.count; ++row)
    for (const PlyProperty& property : element.properties)
      if (!skip_property(cursor, property)) return broken(element, row);
  return absl::OkStatus();
}

/// Where a vertex property goes: position, normal, uv by component; nowhere.
enum Slot { kX, kY, kZ, kNx, kNy, kNz, kU, kV, kSlots, kNowhere = kSlots };

Slot slot_of(const PlyProperty& property) {
  struct SlotName {
    std::string_view name;
    Slot slot;
  };
  static constexpr SlotName kNames[] = {
      {"x", kX},         {"y", kY},         {"z", kZ},         {"nx", kNx},      {"ny", kNy},
      {"nz", kNz},       {"u", kU},         {"v", kV},         {"s", kU},        {"t", kV},
      {"texture_u", kU}, {"texture_v", kV}, {"texture_s", kU}, {"texture_t", kV}};
  if (!property.is_list)
    for (const SlotName& known : kNames)
      if (known.name == property.name) return known.slot;
  return kNowhere;
}

template <class Cursor>
absl::Status read_vertices(Cursor& cursor, const PlyElement& element, TriangleMesh& mesh) {
  std::vector<Slot> slots;
  bool has[kSlots + 1] = {};
  for (const PlyProperty& property : element.properties) {
    slots.push_back(slot_of(property));
    has[slots.back()] = true;
  }
  if (!has[kX] || !has[kY] || !has[kZ]) return invalid_input("the PLY file's vertices have no x, y and z");
  const bool normals = has[kNx] && has[kNy] && has[kNz], uvs = has[kU] && has[kV];
  mesh.positions.resize(element.count);
  if (normals) mesh.normals.resize(element.count);
  if (uvs) mesh.uvs.resize(element.count);
  for (uint64_t row = 0; row < element.count; ++row) {
    double values[kSlots + 1];
    for (size_t k = 0; k < slots.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      const bool ok = slots[k] == kNowhere ? skip_property(cursor, property)
                                           : cursor.read(property.type, values[slots[k]]);
      if (!ok) return broken(element, row);
    }
    mesh.positions[row] = Vec3f(Vec3d(values[kX], values[kY], values[kZ]));
    if (normals) mesh.normals[row] = Vec3f(Vec3d(values[kNx], values[kNy], values[kNz]));
    if (uvs) mesh.uvs[row] = Vec2f(Vec2d(values[kU], values[kV]));
  }
  return absl::OkStatus();
}

/// One face's vertices as a fan about its first.
template <class Cursor>
absl::Status read_face(Cursor& cursor, const PlyElement& element, const PlyProperty& list, uint64_t row,
                       uint64_t vertices, PlyMesh& out) {
  double count = 0;
  if (!cursor.read(list.count_type, count)) return broken(element, row);
  if (count < 0) return invalid_input("face {} of the PLY file has {} vertices", row, count);
  if (!may_follow(cursor, count)) return broken(element, row);
  uint32_t first = 0, last = 0;
  for (uint64_t k = 0; k < static_cast<uint64_t>(count); ++k) {
    double value = 0;
    if (!cursor.read(list.type, value)) return broken(element, row);
    if (!(value >= 0 && value < static_cast<double>(vertices)))
      return invalid_input("face {} of the PLY file: vertex index {} is not from 0 to {}", row, value,
                           static_cast<int64_t>(vertices) - 1);
    const auto index = static_cast<uint32_t>(value);
    if (k >= 2) out.mesh.indices.insert(out.mesh.indices.end(), {first, last, index});
    if (k == 0) first = index;
    last = index;
  }
  if (count < 3) ++out.short_faces;
  return absl::OkStatus();
}

template <class Cursor>
absl::Status read_faces(Cursor& cursor, const PlyElement& element, uint64_t vertices, PlyMesh& out) {
  const PlyProperty* list = nullptr;
  for (const PlyProperty& property : element.properties)
    if (property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index"))
      list = &property;
  if (!list || !is_integer(list->type))
    return invalid_input("the PLY file's faces have no integer list vertex_indices");
  out.mesh.indices.reserve(3 * element.count);
  for (uint64_t row = 0; row < element.count; ++row)
    for (const PlyProperty& property : element.properties) {
      if (&property == list)
        RETURN_IF_ERROR(read_face(cursor, element, property, row, vertices, out));
      else if (!skip_property(cursor, property))
        return broken(element, row);
    }
  return absl::OkStatus();
}

template <class Cursor>
absl::StatusOr<PlyMesh> read_body(const PlyHeader& header, Cursor cursor) {
  PlyMesh out;
  const uint64_t vertices = header.find("vertex")->count;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex")
      RETURN_IF_ERROR(read_vertices(cursor, element, out.mesh));
    else if (element.name == "face")
      RETURN_IF_ERROR(read_faces(cursor, element, vertices, out));
    else
      RETURN_IF_ERROR(skip_element(cursor, element));
  }
  if (const uint64_t rest = cursor.rest(); rest != 0)
    return invalid_input("{} bytes of the PLY file follow its last element", rest);
  return out;
}

absl::Status check_elements(const PlyHeader& header) {
  const PlyElement* const vertex = header.find("vertex");
  if (!vertex || !header.find("face")) return invalid_input("the PLY file lacks an element vertex or face");
  if (vertex->count > UINT32_MAX) return invalid_input("the PLY file has more than 2^32 vertices");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<PlyMesh> read_ply(std::string_view bytes) {
  ASSIGN_OR_RETURN(const PlyHeader header, parse_ply_header(bytes));
  RETURN_IF_ERROR(check_elements(header));
  const std::string_view body = bytes.substr(header.body);
  RETURN_IF_ERROR(check_ply_size(header, body.size()));
  switch (header.format) {
    case PlyFormat::kAscii:
      return read_body(header, AsciiCursor(body));
    case PlyFormat::kLittleEndian:
      return read_body(header, BinaryCursor<false>(body));
    case PlyFormat::kBigEndian:
      return read_body(header, BinaryCursor<true>(body));
  }
  PENUMBRA_CHECK(false);
}

absl::Status check_ply_file(const std::string& path) {
  constexpr size_t kEnoughForHeader = size_t{1} << 16;
  ASSIGN_OR_RETURN(const FileHead head, read_file_head(path, kEnoughForHeader));
  ASSIGN_OR_RETURN(const PlyHeader header, parse_ply_header(head.bytes));
  RETURN_IF_ERROR(check_elements(header));
  if (head.packed) return absl::OkStatus();
  return check_ply_size(header, head.size_on_disk - header.body);
}

}  // namespace penumbra

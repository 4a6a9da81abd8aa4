#pragma once
// The header of a PLY file (Turk 1994): which elements of which properties follow, and how they are coded.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace penumbra {

enum class PlyType : uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

/// Bytes of a binary value.
constexpr uint64_t size_of(PlyType type) {
  constexpr uint64_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}
constexpr bool is_integer(PlyType type) {
  return type < PlyType::kFloat32;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< of a list's length
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  size_t body = 0;  ///< offset of the first byte after the header

  /// Null if there is none.
  const PlyElement* find(std::string_view name) const;
};

/// InvalidArgument names the header's line.
absl::StatusOr<PlyHeader> parse_ply_header(std::string_view bytes);

/// A header that promises more than `body_bytes` can hold is refused before anything is allocated.
absl::Status check_ply_size(const PlyHeader& header, uint64_t body_bytes);

}  // namespace penumbra

#include "scenes/ply_header.h"

#include <charconv>
#include <optional>

#include "proto/status.h"
#include "scenes/diagnostics.h"

namespace penumbra {
namespace {

// Far longer than any header; a file without end_header need not be read to its end.
constexpr size_t kLongestHeader = size_t{1} << 16;

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr TypeName kTypeNames[] = {
    {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},       {"uchar", PlyType::kUint8},
    {"uint8", PlyType::kUint8},    {"short", PlyType::kInt16},     {"int16", PlyType::kInt16},
    {"ushort", PlyType::kUint16},  {"uint16", PlyType::kUint16},   {"int", PlyType::kInt32},
    {"int32", PlyType::kInt32},    {"uint", PlyType::kUint32},     {"uint32", PlyType::kUint32},
    {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32}, {"double", PlyType::kFloat64},
    {"float64", PlyType::kFloat64}};

std::optional<PlyType> type_of(std::string_view name) {
  for (const TypeName& known : kTypeNames)
    if (known.name == name) return known.type;
  return std::nullopt;
}

/// The next line without its end; moves `at` behind it. Empty optional at the end of the bytes.
std::optional<std::string_view> next_line(std::string_view bytes, size_t& at) {
  const size_t eol = bytes.find('\n', at);
  if (eol == std::string_view::npos) return std::nullopt;
  std::string_view line = bytes.substr(at, eol - at);
  at = eol + 1;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr std::string_view kBlanks = " \t";
  for (size_t at = line.find_first_not_of(kBlanks); at != std::string_view::npos;) {
    const size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(kBlanks, end);
  }
  return words;
}

using Words = std::vector<std::string_view>;

/// Empty: fine. Else what is wrong with the line.
std::string read_format(const Words& words, PlyHeader& header) {
  if (words.size() != 3 || words[2] != "1.0") return "expected `format ascii|binary_… 1.0`";
  if (words[1] == "ascii")
    header.format = PlyFormat::kAscii;
  else if (words[1] == "binary_little_endian")
    header.format = PlyFormat::kLittleEndian;
  else if (words[1] == "binary_big_endian")
    header.format = PlyFormat::kBigEndian;
  else
    return fmt::format("unknown format '{}'", printable(words[1]));
  return {};
}

std::string read_element(const Words& words, PlyHeader& header) {
  PlyElement element;
  if (words.size() != 3) return "expected `element NAME COUNT`";
  element.name = words[1];
  const char* const end = words[2].data() + words[2].size();
  const auto [rest, fault] = std::from_chars(words[2].data(), end, element.count);
  if (fault != std::errc() || rest != end)
    return fmt::format("'{}' is no count of elements", printable(words[2]));
  if (header.find(element.name)) return fmt::format("a second element '{}'", printable(element.name));
  header.elements.push_back(std::move(element));
  return {};
}

std::string read_property(const Words& words, PlyHeader& header) {
  if (header.elements.empty()) return "a property before the first element";
  const bool is_list = words.size() > 1 && words[1] == "list";
  if (words.size() != (is_list ? 5u : 3u)) return "expected `property TYPE NAME`";
  PlyProperty property;
  property.is_list = is_list;
  property.name = words.back();
  const auto type = type_of(words[words.size() - 2]);
  const auto count_type = is_list ? type_of(words[2]) : PlyType::kUint8;
  if (!type || !count_type || !is_integer(*count_type))
    return fmt::format("unknown type of property '{}'", printable(property.name));
  property.type = *type;
  property.count_type = *count_type;
  header.elements.back().properties.push_back(std::move(property));
  return {};
}

}  // namespace

const PlyElement* PlyHeader::find(std::string_view name) const {
  for (const PlyElement& element : elements)
    if (element.name == name) return &element;
  return nullptr;
}

absl::StatusOr<PlyHeader> parse_ply_header(std::string_view bytes) {
  bytes = bytes.substr(0, kLongestHeader);
  PlyHeader header;
  size_t at = 0;
  if (next_line(bytes, at) != "ply") return invalid_input("not a PLY file");
  bool has_format = false;
  for (int number = 2;; ++number) {
    const auto line = next_line(bytes, at);
    if (!line) return invalid_input("the PLY header has no end_header");
    const Words words = words_of(*line);
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    std::string fault;
    if (words[0] == "format") {
      fault = read_format(words, header);
      has_format = true;
    } else if (words[0] == "element") {
      fault = read_element(words, header);
    } else if (words[0] == "property") {
      fault = read_property(words, header);
    } else {
      fault = fmt::format("unknown word '{}'", printable(words[0]));
    }
    if (!fault.empty()) return invalid_input("PLY header, line {}: {}", number, fault);
  }
  if (!has_format) return invalid_input("the PLY header has no format line");
  header.body = at;
  return header;
}

absl::Status check_ply_size(const PlyHeader& header, uint64_t body_bytes) {
  uint64_t left = body_bytes;
  for (const PlyElement& element : header.elements) {
    uint64_t least = 0;  // bytes of one row whose lists are empty
    for (const PlyProperty& property : element.properties) {
      if (header.format == PlyFormat::kAscii)
        least += 2;  // a digit and a blank
      else
        least += size_of(property.is_list ? property.count_type : property.type);
    }
    // The very last row of a text needs no blank after it.
    const uint64_t room = left + (header.format == PlyFormat::kAscii ? 1 : 0);
    if (least != 0 && element.count > room / least)
      return invalid_input("the PLY header promises {} × {}, at least {} bytes each, but {} bytes are left",
                           element.count, printable(element.name), least, left);
    left -= std::min(left, element.count * least);
  }
  return absl::OkStatus();
}

}  // namespace penumbra

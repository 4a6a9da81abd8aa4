#include "film/png.h"

#include <zlib.h>

#include <string_view>

#include "proto/status.h"

namespace penumbra {
namespace {

std::string big_endian(uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

/// Length, type, data, CRC of type and data.
std::string chunk(std::string_view type, const std::string& data) {
  const std::string body = std::string(type) + data;
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<uint32_t>(data.size())) + body + big_endian(static_cast<uint32_t>(crc));
}

}  // namespace

std::string png_bytes(int width, int height, const std::vector<uint8_t>& rgb, PngEffort effort) {
  const size_t row = 3 * static_cast<size_t>(width);
  PENUMBRA_CHECK(width > 0 && height > 0 && rgb.size() == row * static_cast<size_t>(height));
  std::string raw;  // each row after its filter's number: none
  for (size_t y = 0; y < static_cast<size_t>(height); ++y) {
    raw += '\0';
    raw.append(reinterpret_cast<const char*>(rgb.data()) + y * row, row);
  }
  uLongf size = compressBound(raw.size());
  std::string packed(size, '\0');
  PENUMBRA_CHECK(compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                           reinterpret_cast<const Bytef*>(raw.data()), raw.size(),
                           effort == PngEffort::kQuick ? Z_BEST_SPEED : Z_DEFAULT_COMPRESSION) == Z_OK);
  packed.resize(size);
  const std::string header = big_endian(static_cast<uint32_t>(width)) +
                             big_endian(static_cast<uint32_t>(height)) +
                             std::string("\x08\x02\x00\x00\x00", 5);  // depth 8, RGB, no interlace
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", packed) + chunk("IEND", "");
}

}  // namespace penumbra

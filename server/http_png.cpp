#include "server/http_png.h"

#include <zlib.h>

#include <string_view>

#include "proto/status.h"

namespace penumbra {
namespace {

std::string big_endian(uint32_t v) {
  return {static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8),
          static_cast<char>(v)};
}

/// Length, type, data, and the CRC of type and data.
std::string chunk(std::string_view type, std::string_view data) {
  std::string body(type);
  body += data;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<uint32_t>(data.size())) + body + big_endian(static_cast<uint32_t>(sum));
}

}  // namespace

std::string png(int width, int height, const std::vector<uint8_t>& rgb) {
  const size_t row = 3 * static_cast<size_t>(width);
  PENUMBRA_CHECK(width > 0 && height > 0 && rgb.size() == row * static_cast<size_t>(height));
  std::string raw;
  raw.reserve((row + 1) * static_cast<size_t>(height));
  for (size_t y = 0; y < static_cast<size_t>(height); ++y) {
    raw += '\0';  // the row's filter: none
    raw.append(reinterpret_cast<const char*>(rgb.data() + y * row), row);
  }
  uLongf size = compressBound(raw.size());
  std::string packed(size, '\0');
  PENUMBRA_CHECK(compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                           reinterpret_cast<const Bytef*>(raw.data()), raw.size(), Z_BEST_SPEED) == Z_OK);
  packed.resize(size);
  // 8 bits a channel, colour type 2 (RGB), deflate, adaptive filters, not interlaced.
  const std::string head = big_endian(static_cast<uint32_t>(width)) +
                           big_endian(static_cast<uint32_t>(height)) + std::string("\x08\x02\x00\x00\x00", 5);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", head) + chunk("IDAT", packed) + chunk("IEND", "");
}

}  // namespace penumbra

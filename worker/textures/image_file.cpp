#include "worker/textures/image_file.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "proto/status.h"
#include "worker/textures/cie.h"

namespace penumbra {
namespace {

float decode_srgb(float v) {
  if (v <= 0.04045f) return v / 12.92f;
  return std::pow((v + 0.055f) / 1.055f, 2.4f);
}

float decode(float v, const Encoding& encoding) {
  switch (encoding.kind) {
    case Encoding::kSrgb:
      return decode_srgb(v);
    case Encoding::kGamma:
      return v > 0 ? std::pow(v, encoding.gamma) : v;
    default:
      return v;
  }
}

/// An image's first three channels (or its first) as stored: integers of 8 bits as such, others as floats
/// with integers scaled to [0,1].
struct Stored {
  int width = 0, height = 0, channels = 0;
  bool integers = false;
  std::vector<uint8_t> bytes;
  std::vector<float> values;  ///< where bytes is empty
};

absl::StatusOr<Stored> read_stored(const std::string& path) {
  OIIO::ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);  // colours as stored, not multiplied by alpha
  const auto fault = [](const std::string& text) {
    return make_status(absl::StatusCode::kNotFound, "{}", text);
  };
  auto input = OIIO::ImageInput::open(path, &hints);
  if (!input) return fault(OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  constexpr int64_t kMostTexels = int64_t{1} << 30;  // 12 GB as floats: a lying header, not a texture
  if (spec.width <= 0 || spec.height <= 0 || int64_t{spec.width} * spec.height > kMostTexels) {
    return fault(fmt::format("{} x {} texels", spec.width, spec.height));
  }
  Stored stored{spec.width, spec.height, spec.nchannels >= 3 ? 3 : 1, !spec.format.is_floating_point(),
                {},         {}};
  const size_t size = static_cast<size_t>(spec.width) * spec.height * stored.channels;
  const auto read = [&](OIIO::TypeDesc type, void* to) {
    return input->read_image(0, 0, 0, stored.channels, type, to);
  };
  bool complete = false;
  if (spec.format == OIIO::TypeDesc::UINT8) {
    stored.bytes.resize(size);
    complete = read(OIIO::TypeDesc::UINT8, stored.bytes.data());
  } else {
    stored.values.resize(size);
    complete = read(OIIO::TypeDesc::FLOAT, stored.values.data());
  }
  if (!complete) return fault(input->geterror());
  return stored;
}

/// Bytes to linear values by table: one power per byte value, not per texel.
std::vector<float> decode_bytes(const std::vector<uint8_t>& bytes, const Encoding& encoding) {
  std::array<float, 256> table;
  for (int i = 0; i < 256; ++i) table[i] = decode(static_cast<float>(i) / 255, encoding);
  std::vector<float> values(bytes.size());
  std::transform(bytes.begin(), bytes.end(), values.begin(), [&](uint8_t b) { return table[b]; });
  return values;
}

std::vector<float> luminances(const std::vector<float>& rgb) {
  std::vector<float> grey(rgb.size() / 3);
  for (size_t i = 0; i < grey.size(); ++i) {
    grey[i] = luminance(Rgb(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]));
  }
  return grey;
}

}  // namespace

absl::StatusOr<Texels> read_image(const std::string& path, bool grey, const Encoding& encoding) {
  ASSIGN_OR_RETURN(Stored stored, read_stored(path));
  Encoding chosen = encoding;
  if (chosen.kind == Encoding::kAutomatic)
    chosen.kind = stored.integers ? Encoding::kSrgb : Encoding::kLinear;
  const bool to_grey = grey && stored.channels == 3;
  if (!stored.bytes.empty() && !to_grey) {
    return Texels{stored.width, stored.height, stored.channels, decode_bytes(stored.bytes, chosen)};
  }
  if (!stored.bytes.empty()) stored.values = decode_bytes(stored.bytes, Encoding{Encoding::kLinear});
  if (to_grey) stored.values = luminances(stored.values);
  for (float& v : stored.values) v = decode(v, chosen);
  if (!std::all_of(stored.values.begin(), stored.values.end(), [](float v) { return std::isfinite(v); })) {
    return invalid_input("{}: a value that is not finite", path);
  }
  return Texels{stored.width, stored.height, to_grey ? 1 : stored.channels, std::move(stored.values)};
}

}  // namespace penumbra

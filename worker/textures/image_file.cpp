#include "worker/textures/image_file.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

/// Stored numbers of the first three channels (or the first) as floats, integers scaled to [0,1].
struct Stored {
  int width = 0, height = 0, channels = 0;
  bool integers = false;
  std::vector<float> values;
};

absl::StatusOr<Stored> read_stored(const std::string& path) {
  OIIO::ImageSpec hints;
  hints.attribute("oiio:UnassociatedAlpha", 1);  // colours as stored, not multiplied by alpha
  auto input = OIIO::ImageInput::open(path, &hints);
  if (!input) return make_status(absl::StatusCode::kNotFound, "{}", OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  constexpr int64_t kMostTexels = int64_t{1} << 30;  // 12 GB as floats: a lying header, not a texture
  if (spec.width <= 0 || spec.height <= 0 || int64_t{spec.width} * spec.height > kMostTexels) {
    return make_status(absl::StatusCode::kNotFound, "{} x {} texels", spec.width, spec.height);
  }
  Stored stored{spec.width, spec.height, spec.nchannels >= 3 ? 3 : 1, !spec.format.is_floating_point(), {}};
  stored.values.resize(static_cast<size_t>(spec.width) * spec.height * stored.channels);
  if (!input->read_image(0, 0, 0, stored.channels, OIIO::TypeDesc::FLOAT, stored.values.data())) {
    return make_status(absl::StatusCode::kNotFound, "{}", input->geterror());
  }
  return stored;
}

void to_grey(Stored& stored) {
  if (stored.channels == 1) return;
  const size_t n = stored.values.size() / 3;
  for (size_t i = 0; i < n; ++i) {
    const float* v = &stored.values[3 * i];
    stored.values[i] = luminance(Rgb(v[0], v[1], v[2]));
  }
  stored.values.resize(n);
  stored.channels = 1;
}

/// 8-bit files have 256 values: remembering the last ones decoded saves most of the powers.
void decode_all(std::vector<float>& values, const Encoding& encoding) {
  if (encoding.kind == Encoding::kLinear) return;
  std::array<float, 256> table;
  for (int i = 0; i < 256; ++i) table[i] = decode(static_cast<float>(i) / 255, encoding);
  for (float& v : values) {
    const float scaled = v * 255;
    const float index = std::round(scaled);
    v = index >= 0 && index <= 255 && static_cast<float>(index) / 255 == v ? table[static_cast<int>(index)]
                                                                           : decode(v, encoding);
  }
}

}  // namespace

absl::StatusOr<Texels> read_image(const std::string& path, bool grey, const Encoding& encoding) {
  ASSIGN_OR_RETURN(Stored stored, read_stored(path));
  if (grey) to_grey(stored);
  Encoding chosen = encoding;
  if (chosen.kind == Encoding::kAutomatic)
    chosen.kind = stored.integers ? Encoding::kSrgb : Encoding::kLinear;
  decode_all(stored.values, chosen);
  if (!std::all_of(stored.values.begin(), stored.values.end(), [](float v) { return std::isfinite(v); })) {
    return invalid_input("{}: a value that is not finite", path);
  }
  return Texels{stored.width, stored.height, stored.channels, std::move(stored.values)};
}

}  // namespace penumbra

#include "client/frames.h"

#include <algorithm>

#include "proto/convert.h"
#include "proto/status.h"

namespace penumbra {
namespace {

absl::Status broken(const v1::FrameChunk& chunk, std::string_view why) {
  return make_status(absl::StatusCode::kDataLoss, "frame of mix {}, checkpoint {}: {}", chunk.mix(),
                     chunk.checkpoint(), why);
}

/// Copies the rows of a rectangle into a layer; an absent layer (not final) stays absent.
void scatter(const google::protobuf::RepeatedField<float>& from, const PixelRect& rect, size_t channels,
             const FilmImage& image, std::vector<float>& to) {
  const auto row = static_cast<std::ptrdiff_t>(channels) * rect.width();
  auto source = from.begin();
  for (int y = rect.y0; y < rect.y1; ++y, source += row)
    std::copy(source, source + row,
              to.begin() + static_cast<std::ptrdiff_t>(channels * image.index(rect.x0, y)));
}

/// Passes and costs are the picture's; its bins have the same.
bool has_counts(const v1::FrameChunk& chunk) {
  return chunk.final() && chunk.bin() == 0;
}

}  // namespace

FrameAssembler::Growing FrameAssembler::begin(const v1::FrameChunk& chunk) const {
  Growing growing;
  growing.frame.mix = chunk.mix();
  growing.frame.checkpoint = chunk.checkpoint();
  growing.frame.bin = chunk.bin();
  growing.frame.final = chunk.final();
  FilmImage& image = growing.frame.image;
  image.width = spec_.width;
  image.height = spec_.height;
  image.window = spec_.crop;
  image.rgb.resize(3 * image.pixels());
  if (chunk.final()) image.variance.resize(3 * image.pixels());
  if (has_counts(chunk)) {
    image.samples.resize(image.pixels());
    image.cost.resize(image.pixels());
  }
  return growing;
}

absl::StatusOr<std::optional<ArrivedFrame>> FrameAssembler::add(const v1::FrameChunk& chunk) {
  if (chunk.mix() < 0 || chunk.mix() >= static_cast<int>(spec_.mixes.size()))
    return broken(chunk, "no such mix");
  const int bins = spec_.transient ? spec_.transient->bins : 0;
  if (chunk.bin() < 0 || chunk.bin() > bins || (chunk.bin() > 0 && !chunk.final()))
    return broken(chunk, "no such bin");
  ASSIGN_OR_RETURN(const PixelRect rect, from_proto(chunk.rect()));
  if (rect.area() <= 0 || !contains(spec_.crop, rect)) return broken(chunk, "a rectangle outside the crop");
  const auto pixels = rect.area();
  if (chunk.mean_size() != 3 * pixels) return broken(chunk, "values that do not fill their rectangle");
  const bool counts = has_counts(chunk);
  if ((chunk.final() && chunk.variance_size() != 3 * pixels) ||
      (counts && (chunk.samples_size() != pixels || chunk.cost_size() != pixels)))
    return broken(chunk, "layers that do not fill their rectangle");

  const std::array key{chunk.mix(), chunk.checkpoint(), chunk.bin()};
  auto it = growing_.find(key);
  if (it == growing_.end()) it = growing_.emplace(key, begin(chunk)).first;
  Growing& growing = it->second;
  if (growing.frame.final != chunk.final()) return broken(chunk, "chunks of two frames under one name");
  FilmImage& image = growing.frame.image;
  scatter(chunk.mean(), rect, 3, image, image.rgb);
  if (chunk.final()) scatter(chunk.variance(), rect, 3, image, image.variance);
  if (counts) {
    scatter(chunk.samples(), rect, 1, image, image.samples);
    scatter(chunk.cost(), rect, 1, image, image.cost);
  }
  growing.pixels += pixels;
  if (!chunk.last()) return std::nullopt;
  if (growing.pixels != spec_.crop.area())
    return broken(chunk, fmt::format("{} of {} pixels", growing.pixels, spec_.crop.area()));
  ArrivedFrame whole = std::move(growing.frame);
  growing_.erase(it);
  return whole;
}

}  // namespace penumbra

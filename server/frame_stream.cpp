#include "server/frame_stream.h"

#include <algorithm>

#include "proto/convert.h"

namespace penumbra {
namespace {

// Pixels of one chunk: with 8 floats each it stays below a megabyte.
constexpr int64_t kChunkPixels = 1 << 15;

// Rows of a summary that travel in one message: a megabyte and a half. A large farm's run has a million.
constexpr int kRowsOfMessage = 16384;

/// Rows [y0,y1) of a layer with `channels` floats per pixel.
void copy_rows(const std::vector<float>& layer, size_t channels, const PixelRect& window, int y0, int y1,
               google::protobuf::RepeatedField<float>& out) {
  const size_t row = static_cast<size_t>(window.width()) * channels;
  const float* begin = layer.data() + static_cast<size_t>(y0 - window.y0) * row;
  out.Add(begin, begin + static_cast<size_t>(y1 - y0) * row);
}

}  // namespace

absl::Status FrameStream::write(const v1::FetchFramesResponse& message) {
  return writer_.Write(message) ? absl::OkStatus() : absl::CancelledError("the client has hung up");
}

std::vector<v1::RunSummary> parts_of(v1::RunSummary summary, int rows) {
  google::protobuf::RepeatedPtrField<v1::TileRow> tiles;
  summary.mutable_tiles()->Swap(&tiles);
  std::vector<v1::RunSummary> parts;
  parts.push_back(std::move(summary));
  for (int row = 0; row < tiles.size(); ++row) {
    if (row > 0 && row % rows == 0) parts.emplace_back();
    parts.back().add_tiles()->Swap(tiles.Mutable(row));
  }
  return parts;
}

absl::Status FrameStream::summary(const RunSummary& summary) {
  for (v1::RunSummary& part : parts_of(to_proto(summary), kRowsOfMessage)) {
    v1::FetchFramesResponse message;
    message.mutable_summary()->Swap(&part);
    if (absl::Status status = write(message); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status FrameStream::frame(const AssembledFrame& frame) {
  const PixelRect& window = frame.image.window;
  const int rows = static_cast<int>(std::max<int64_t>(1, kChunkPixels / window.width()));
  for (int y0 = window.y0; y0 < window.y1; y0 += rows) {
    const int y1 = std::min(y0 + rows, window.y1);
    v1::FetchFramesResponse message;
    v1::FrameChunk& chunk = *message.mutable_frame();
    chunk.set_mix(frame.mix);
    chunk.set_checkpoint(frame.checkpoint);
    if (frame.bin) chunk.set_bin(*frame.bin + 1);
    chunk.set_final(frame.final);
    *chunk.mutable_rect() = to_proto(PixelRect{window.x0, y0, window.x1, y1});
    copy_rows(frame.image.rgb, 3, window, y0, y1, *chunk.mutable_mean());
    if (frame.final) {
      copy_rows(frame.image.variance, 3, window, y0, y1, *chunk.mutable_variance());
    }
    if (frame.final && !frame.bin) {
      copy_rows(frame.image.samples, 1, window, y0, y1, *chunk.mutable_samples());
      copy_rows(frame.image.cost, 1, window, y0, y1, *chunk.mutable_cost());
    }
    chunk.set_last(y1 == window.y1);
    if (absl::Status status = write(message); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status FrameStream::end(double scheduler_cpu_seconds) {
  v1::FetchFramesResponse message;
  message.mutable_end()->set_scheduler_cpu_seconds(scheduler_cpu_seconds);
  return write(message);
}

}  // namespace penumbra

#include "film/tile_pixels.h"

#include <algorithm>
#include <bit>

#include "film/bytes.h"
#include "proto/status.h"

namespace penumbra {
namespace {

constexpr std::string_view kMagic = "PNTR";
constexpr uint32_t kVersion = 3, kVersionWithoutBins = 2, kVersionWithoutBlocks = 1;
constexpr size_t kLeastMixBytes = 4 * sizeof(int32_t) + 2 * sizeof(int64_t);

// By their bits, without a branch per value, so that the loop is vectorised: an exponent of all ones is an
// infinity or a NaN.
constexpr uint32_t kInfinity = 0x7f80'0000u, kSign = 0x8000'0000u;

bool finite(std::span<const float> values) {
  bool bad = false;
  for (const float value : values) bad |= (std::bit_cast<uint32_t>(value) & kInfinity) == kInfinity;
  return !bad;
}

/// Finite and >= 0, which includes -0.
bool finite_and_not_negative(std::span<const float> values) {
  bool bad = false;
  for (const float value : values) {
    const uint32_t bits = std::bit_cast<uint32_t>(value);
    bad |= bits >= kInfinity && bits != kSign;
  }
  return !bad;
}

std::string fault_of_header(const TileView& p) {
  const PixelRect& r = p.rect;
  if (r.x0 < 0 || r.y0 < 0 || r.x1 <= r.x0 || r.y1 <= r.y0)
    return fmt::format("rect {},{},{},{} is empty or negative", r.x0, r.y0, r.x1, r.y1);
  if (p.passes < 0) return fmt::format("{} passes", p.passes);
  if (p.groups > p.passes || (p.passes > 0 && p.groups < 1) || p.groups < 0)
    return fmt::format("{} groups of {} passes", p.groups, p.passes);
  return {};
}

std::string fault_of_blocks(const TileView& p) {
  if (p.block_passes.size() != p.block_groups.size()) return "block counts of different lengths";
  if (p.block_passes.empty()) return {};
  if (p.passes == 0 || p.block_passes.size() != block_count(p.rect))
    return fmt::format("counts of {} blocks for {} passes of {}", p.block_passes.size(), p.passes,
                       block_count(p.rect));
  for (size_t b = 0; b < p.block_passes.size(); ++b) {
    const int32_t passes = p.block_passes[b], groups = p.block_groups[b];
    if (passes < 0 || passes > p.passes || groups < 0 || groups > passes || (passes > 0 && groups == 0))
      return fmt::format("block {}: {} groups of {} passes of {}", b, groups, passes, p.passes);
  }
  return {};
}

std::string fault_of_bins(const TileView& p, size_t pixels) {
  const size_t values = 3 * pixels * static_cast<size_t>(std::max(p.bins, 0));
  if (p.bins < 0 || p.bin_mean.size() != values || p.bin_m2.size() != values)
    return fmt::format("arrays of {}, {} values for {} bins of {} pixels", p.bin_mean.size(), p.bin_m2.size(),
                       p.bins, pixels);
  if (!finite(p.bin_mean)) return "a bin's mean is not finite";
  if (!finite_and_not_negative(p.bin_m2)) return "a bin's m2 is negative or not finite";
  return {};
}

}  // namespace

TileView TileView::bin(int b) const {
  const size_t values = 3 * static_cast<size_t>(rect.area()), first = static_cast<size_t>(b) * values;
  TileView out = *this;
  out.bins = 0;
  out.cost = out.bin_mean = out.bin_m2 = {};
  out.mean = passes > 0 ? bin_mean.subspan(first, values) : std::span<const float>();
  out.m2 = passes > 0 ? bin_m2.subspan(first, values) : std::span<const float>();
  return out;
}

std::string fault_of(const TileView& p) {
  if (std::string fault = fault_of_header(p); !fault.empty()) return fault;
  if (std::string fault = fault_of_blocks(p); !fault.empty()) return fault;
  const bool absent = p.passes == 0 && p.mean.empty() && p.m2.empty() && p.cost.empty();
  const size_t pixels = absent ? 0 : static_cast<size_t>(p.rect.area());
  if (p.mean.size() != 3 * pixels || p.m2.size() != 3 * pixels || p.cost.size() != pixels)
    return fmt::format("arrays of {}, {}, {} values for {} pixels", p.mean.size(), p.m2.size(), p.cost.size(),
                       pixels);
  if (!finite(p.mean)) return "a mean is not finite";
  if (!finite_and_not_negative(p.m2)) return "an m2 is negative or not finite";
  if (!finite_and_not_negative(p.cost)) return "a cost is negative or not finite";
  return fault_of_bins(p, pixels);
}

std::string serialize(const TileResult& result) {
  ByteWriter out;
  out.put(kMagic);
  out.put(kVersion);
  out.put(static_cast<uint32_t>(result.mixes.size()));
  for (const TilePixels& p : result.mixes) {
    PENUMBRA_CHECK(fault_of(p).empty());
    for (const int32_t edge : {p.rect.x0, p.rect.y0, p.rect.x1, p.rect.y1}) out.put(edge);
    out.put(p.passes);
    out.put(p.groups);
    out.put(static_cast<uint32_t>(p.passes > 0 ? p.block_passes.size() : 0));
    out.put(static_cast<uint32_t>(p.bins));
    if (p.passes == 0) continue;
    out.put(p.block_passes);
    out.put(p.block_groups);
    out.put(p.mean);
    out.put(p.m2);
    out.put(p.cost);
    out.put(p.bin_mean);
    out.put(p.bin_m2);
  }
  return out.take();
}

absl::StatusOr<ReceivedTile> ReceivedTile::parse(std::string bytes) {
  ReceivedTile tile;
  tile.bytes_ = std::make_unique<const std::string>(std::move(bytes));
  RETURN_IF_ERROR(tile.read());
  return tile;
}

absl::Status ReceivedTile::read() {
  ByteReader in(*bytes_);
  uint32_t version = 0, mixes = 0;
  if (!in.expect(kMagic) || !in.get(version) || !in.get(mixes))
    return invalid_input("tile result: not a tile result");
  if (version != kVersion && version != kVersionWithoutBins && version != kVersionWithoutBlocks)
    return invalid_input("tile result: version {}, not {}", version, kVersion);
  if (mixes > in.left() / kLeastMixBytes)
    return invalid_input("tile result: {} mixes in {} bytes", mixes, in.left());
  mixes_.resize(mixes);
  for (uint32_t m = 0; m < mixes; ++m) {
    TileView& p = mixes_[m];
    uint32_t blocks = 0, bins = 0;
    if (!in.get(p.rect.x0) || !in.get(p.rect.y0) || !in.get(p.rect.x1) || !in.get(p.rect.y1) ||
        !in.get(p.passes) || !in.get(p.groups) || (version != kVersionWithoutBlocks && !in.get(blocks)) ||
        (version == kVersion && !in.get(bins)))
      return invalid_input("tile result: mix {}: truncated", m);
    if (const std::string fault = fault_of_header(p); !fault.empty())
      return invalid_input("tile result: mix {}: {}", m, fault);
    // An area below 2^62; its tripling cannot overflow, and view() bounds it by the bytes that are left.
    const uint64_t pixels = p.passes > 0 ? static_cast<uint64_t>(p.rect.area()) : 0;
    if (bins > uint32_t{kMostBins}) return invalid_input("tile result: mix {}: {} bins", m, bins);
    p.bins = static_cast<int>(bins);
    if (!in.view(p.block_passes, blocks) || !in.view(p.block_groups, blocks) ||
        !in.view(p.mean, 3 * pixels) || !in.view(p.m2, 3 * pixels) || !in.view(p.cost, pixels) ||
        !in.view(p.bin_mean, 3 * pixels * bins) || !in.view(p.bin_m2, 3 * pixels * bins))
      return invalid_input("tile result: mix {}: truncated", m);
    if (const std::string fault = fault_of(p); !fault.empty())
      return invalid_input("tile result: mix {}: {}", m, fault);
  }
  if (in.left() != 0) return invalid_input("tile result: {} bytes too many", in.left());
  return absl::OkStatus();
}

}  // namespace penumbra

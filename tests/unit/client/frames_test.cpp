#include "client/frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert.h"
#include "proto/status.h"

namespace penumbra {
namespace {

using testing::HasSubstr;

JobSpec spec() {
  JobSpec s;
  s.width = 8;
  s.height = 6;
  s.crop = {2, 1, 6, 5};
  s.mixes = {*parse_mix("bsdf:1"), *parse_mix("sa:1")};
  return s;
}

v1::FrameChunk chunk(int mix, int checkpoint, const PixelRect& rect, bool final, bool last) {
  v1::FrameChunk c;
  c.set_mix(mix);
  c.set_checkpoint(checkpoint);
  c.set_final(final);
  c.set_last(last);
  *c.mutable_rect() = to_proto(rect);
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) {
      for (int k = 0; k < 3; ++k) c.add_mean(static_cast<float>(100 * y + 10 * x + k));
      if (!final) continue;
      for (int k = 0; k < 3; ++k) c.add_variance(0.5f);
      c.add_samples(4);
      c.add_cost(static_cast<float>(x));
    }
  return c;
}

TEST(FrameAssembler, PutsRectanglesInTheirPlaces) {
  FrameAssembler assembler(spec());
  EXPECT_FALSE(assembler.add(chunk(1, 0, {2, 1, 4, 5}, true, false))->has_value());
  EXPECT_EQ(assembler.pending(), 1u);
  const auto frame = assembler.add(chunk(1, 0, {4, 1, 6, 5}, true, true));
  ASSERT_TRUE(frame.ok()) << message_of(frame.status());
  ASSERT_TRUE(frame->has_value());
  EXPECT_EQ((*frame)->mix, 1);
  EXPECT_TRUE((*frame)->final);
  const FilmImage& image = (*frame)->image;
  EXPECT_EQ(image.window, spec().crop);
  for (int y = 1; y < 5; ++y)
    for (int x = 2; x < 6; ++x) {
      EXPECT_EQ(image.rgb[3 * image.index(x, y) + 2], static_cast<float>(100 * y + 10 * x + 2));
      EXPECT_EQ(image.cost[image.index(x, y)], static_cast<float>(x));
    }
  EXPECT_EQ(image.samples, std::vector<float>(16, 4.0f));
  EXPECT_EQ(assembler.pending(), 0u);
}

TEST(FrameAssembler, FramesMayInterleave) {
  FrameAssembler assembler(spec());
  ASSERT_TRUE(assembler.add(chunk(0, 0, {2, 1, 6, 3}, false, false)).ok());
  ASSERT_TRUE(assembler.add(chunk(1, 0, {2, 1, 6, 3}, false, false)).ok());
  const auto first = assembler.add(chunk(0, 0, {2, 3, 6, 5}, false, true));
  ASSERT_TRUE(first->has_value());
  EXPECT_EQ((**first).mix, 0);
  EXPECT_TRUE((**first).image.samples.empty());
  EXPECT_TRUE(assembler.add(chunk(1, 0, {2, 3, 6, 5}, false, true))->has_value());
}

TEST(FrameAssembler, RefusesWhatDoesNotFit) {
  const auto fault = [](const v1::FrameChunk& c) {
    FrameAssembler assembler(spec());
    const auto added = assembler.add(c);
    EXPECT_EQ(added.status().code(), absl::StatusCode::kDataLoss);
    return message_of(added.status());
  };
  EXPECT_THAT(fault(chunk(2, 0, {2, 1, 4, 5}, true, true)), HasSubstr("no such mix"));
  EXPECT_THAT(fault(chunk(0, 0, {1, 1, 4, 5}, true, true)), HasSubstr("outside the crop"));
  EXPECT_THAT(fault(chunk(0, 0, {2, 1, 4, 5}, true, true)), HasSubstr("8 of 16 pixels"));
  v1::FrameChunk shorter = chunk(0, 0, {2, 1, 6, 5}, true, true);
  shorter.mutable_mean()->RemoveLast();
  EXPECT_THAT(fault(shorter), HasSubstr("do not fill"));
}

v1::FrameChunk bin_chunk(int bin) {
  v1::FrameChunk c = chunk(0, 0, {2, 1, 6, 5}, true, true);
  c.set_bin(bin);
  c.clear_samples();
  c.clear_cost();
  return c;
}

TEST(FrameAssembler, BinsAreFramesOfTheirOwn) {
  JobSpec with_bins = spec();
  with_bins.transient = Transient{0, 1, 2};
  FrameAssembler assembler(with_bins);
  const auto bin = assembler.add(bin_chunk(2));
  ASSERT_TRUE(bin.ok()) << message_of(bin.status());
  ASSERT_TRUE(bin->has_value());
  EXPECT_EQ((**bin).bin, 2);
  EXPECT_EQ((**bin).image.variance.size(), 48u);
  EXPECT_TRUE((**bin).image.samples.empty());
  EXPECT_FALSE(assembler.add(bin_chunk(3)).ok()) << "there are two";
  EXPECT_FALSE(FrameAssembler(spec()).add(bin_chunk(1)).ok()) << "the job has none";
}

}  // namespace
}  // namespace penumbra

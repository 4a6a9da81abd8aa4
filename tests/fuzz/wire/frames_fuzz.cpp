// Any sequence of frame chunks at the client: whole frames of the right size, or errors.
#include <google/protobuf/stubs/logging.h>

#include <cstddef>

#include "client/frames.h"
#include "proto/status.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
  google::protobuf::SetLogHandler(nullptr);  // a line of each text that is no text would take longest
  penumbra::JobSpec spec;
  spec.mixes = {*penumbra::parse_mix("sa:1"), *penumbra::parse_mix("bsdf:1")};
  spec.width = spec.height = 8;
  spec.crop = {1, 2, 3, 4};  // a whole frame fits into one chunk of the input
  spec.transient = penumbra::Transient{0, 1, 2};
  penumbra::FrameAssembler frames(spec);
  while (count > 1) {  // a byte of length, then a chunk
    const size_t size = std::min<size_t>(bytes[0], count - 1);
    penumbra::v1::FrameChunk chunk;
    if (chunk.ParseFromArray(bytes + 1, static_cast<int>(size))) {
      const auto frame = frames.add(chunk);
      if (frame.ok() && *frame) PENUMBRA_CHECK((*frame)->image.rgb.size() == 3 * 4);
    }
    bytes += size + 1;
    count -= size + 1;
  }
  return 0;
}

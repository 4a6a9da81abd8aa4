// Any bytes as a PLY file: an error, or a mesh whose indices are in range.
#include <cstddef>

#include "proto/status.h"
#include "scenes/ply.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
  const auto ply = penumbra::read_ply({reinterpret_cast<const char*>(bytes), count});
  if (!ply.ok()) return 0;
  for (const uint32_t index : ply->mesh.indices) PENUMBRA_CHECK(index < ply->mesh.positions.size());
  return 0;
}

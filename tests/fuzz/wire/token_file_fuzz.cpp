// Any bytes as a token file: an error, or entries with a role each.
#include <cstddef>

#include "proto/status.h"
#include "server/token_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
  const auto entries = penumbra::parse_token_file("f", {reinterpret_cast<const char*>(bytes), count});
  if (!entries.ok()) return 0;
  for (const penumbra::TokenEntry& entry : *entries) PENUMBRA_CHECK(entry.roles != 0);
  return 0;
}

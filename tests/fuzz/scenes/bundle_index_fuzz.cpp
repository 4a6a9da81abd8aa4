// Any bytes as a bundle's index: an error, or names that stay inside and come back the same.
#include <cstddef>

#include "proto/status.h"
#include "scenes/bundle.h"
#include "scenes/bundle_names.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
  const auto index = penumbra::parse_bundle_index({reinterpret_cast<const char*>(bytes), count});
  if (!index.ok()) return 0;
  for (const penumbra::BundleEntry& entry : index->entries)
    PENUMBRA_CHECK(penumbra::check_bundle_name(entry.name).ok());
  PENUMBRA_CHECK(penumbra::parse_bundle_index(penumbra::serialize(*index)).value() == *index);
  return 0;
}

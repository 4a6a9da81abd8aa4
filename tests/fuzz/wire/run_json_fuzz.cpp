// Any bytes as a run.json to replay: an error, or a job.
#include <cstddef>

#include "client/run_json.h"
#include "proto/status.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
  const penumbra::Json json = penumbra::Json::parse(bytes, bytes + count, nullptr, false);
  if (json.is_discarded()) return 0;
  const auto spec = penumbra::replay_spec(json);
  if (spec.ok()) PENUMBRA_CHECK(spec->plan.size() == spec->mixes.size());
  return 0;
}

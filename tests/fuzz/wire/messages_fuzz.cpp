// Any bytes as any message of any RPC: an error that names a field, or a value that comes back the same.
// The first byte says which message.
#include <google/protobuf/stubs/logging.h>

#include <cstddef>

#include "proto/convert.h"
#include "proto/status.h"

namespace {

template <class Message>
void convert(const uint8_t* bytes, size_t count) {
  Message message;
  if (!message.ParseFromArray(bytes, static_cast<int>(count))) return;
  const auto value = penumbra::from_proto(message);
  if (!value.ok()) {
    PENUMBRA_CHECK(!value.status().message().empty());
    return;
  }
  const auto again = penumbra::from_proto(penumbra::to_proto(*value));
  PENUMBRA_CHECK(again.ok() && *again == *value);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
  if (count == 0) return 0;
  google::protobuf::SetLogHandler(
      nullptr);  // text that is no text is refused; a line of each would take longest
  using namespace penumbra::v1;
  static constexpr void (*kConvert[])(const uint8_t*, size_t) = {
      convert<JobSpec>,    convert<JobTerms>,   convert<SyncRequest>,       convert<SyncResponse>,
      convert<JobStatus>,  convert<RunSummary>, convert<LogResponse::Line>, convert<TileTask>,
      convert<LoadReport>, convert<WorkerInfo>, convert<MixCost>,           convert<MixSummary>,
      convert<TileRow>,    convert<PixelRect>};
  kConvert[bytes[0] % std::size(kConvert)](bytes + 1, count - 1);
  return 0;
}

#pragma once
#include <vector>

#include "absl/status/status.h"
#include "proto/render.grpc.pb.h"
#include "proto/run.h"
#include "server/assembler.h"

namespace penumbra {

/// A summary as messages: the first has everything but the tiles beyond so many rows, the others these.
/// Merged in order they are what it was.
std::vector<v1::RunSummary> parts_of(v1::RunSummary summary, int rows);

/// Cuts summary, frames and end into the messages of FetchFrames. Cancelled when the client hangs up.
class FrameStream {
 public:
  explicit FrameStream(grpc::ServerWriter<v1::FetchFramesResponse>& writer) : writer_(writer) {}
  absl::Status summary(const RunSummary& summary);
  absl::Status frame(const AssembledFrame& frame);
  absl::Status end(double scheduler_cpu_seconds);

 private:
  absl::Status write(const v1::FetchFramesResponse& message);
  grpc::ServerWriter<v1::FetchFramesResponse>& writer_;
};

}  // namespace penumbra

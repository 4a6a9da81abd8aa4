#include "server/worker_service.h"

#include <atomic>

#include "film/tile_pixels.h"
#include "proto/convert.h"
#include "proto/rpc_status.h"

namespace penumbra {
namespace {

/// Reads a result's bytes: they must be whole, finite, and of one rectangle.
absl::StatusOr<ResultShape> shape_of(const BlobFolder& blobs, const CompletedTask& task) {
  if (task.result.empty()) return ResultShape{};  // a pilot; the scheduler refuses it for anything else
  // Verified when they were uploaded, moments ago, and again when they are merged.
  ASSIGN_OR_RETURN(std::string bytes, blobs.read_unverified(task.result));
  ASSIGN_OR_RETURN(const ReceivedTile result, ReceivedTile::parse(std::move(bytes)));
  ResultShape shape;
  for (const TileView& mix : result.mixes()) {
    if (!shape.passes.empty() && mix.rect != shape.rect)
      return invalid_input("result {}: its mixes cover different tiles", task.result);
    shape.rect = mix.rect;
    shape.passes.push_back(mix.passes);
    shape.block_passes.emplace_back(mix.block_passes.begin(), mix.block_passes.end());
    shape.bins.push_back(mix.bins);
  }
  return shape;
}

/// One call. Lives until gRPC says that it is over; finished exactly once, by the coordinator's reply.
class SyncCall final : public grpc::ServerUnaryReactor {
 public:
  SyncCall(Coordinator& coordinator, const v1::SyncRequest& request, v1::SyncResponse& response)
      : coordinator_(coordinator) {
    ticket_ = coordinator.new_ticket();
    absl::StatusOr<WorkerState> state = from_proto(request);
    if (!state.ok()) {
      Finish(to_grpc(state.status()));
      return;
    }
    std::vector<absl::StatusOr<ResultShape>> shapes;
    for (const CompletedTask& task : state->completed) shapes.push_back(shape_of(coordinator.blobs(), task));
    coordinator.sync(ticket_, *std::move(state), std::move(shapes),
                     [this, &response](absl::StatusOr<DesiredState> desired) {
                       if (desired.ok()) response = to_proto(*desired);
                       Finish(to_grpc(desired.status()));
                     });
  }

  void OnCancel() override {
    const uint64_t ticket = ticket_;
    coordinator_.cancel_sync(ticket);
  }
  void OnDone() override { delete this; }

 private:
  Coordinator& coordinator_;
  /// Written when what OnCancel reads is there, and read first: gRPC orders the two as well, but unseen by
  /// those who look for races.
  std::atomic<uint64_t> ticket_{0};
};

}  // namespace

grpc::ServerUnaryReactor* WorkerService::Sync(grpc::CallbackServerContext*, const v1::SyncRequest* request,
                                              v1::SyncResponse* response) {
  return new SyncCall(coordinator_, *request, *response);
}

}  // namespace penumbra

#include "server/worker_service.h"

#include <atomic>

#include "film/tile_pixels.h"
#include "proto/convert.h"
#include "proto/rpc_status.h"

namespace penumbra {
namespace {

/// A result's bytes, which lie in the folder when this returns; those that came along are taken from the
/// task. NotFound: they have to be uploaded. InvalidArgument: they are not what the digest says.
absl::StatusOr<std::string> bytes_of(const BlobFolder& blobs, const BlobLimits& limits, CompletedTask& task) {
  // Verified when they were uploaded, moments ago, and again when they are merged.
  if (task.bytes.empty()) return blobs.read_unverified(task.result);
  absl::Status kept = check_room(blobs, limits, task.result, task.bytes.size());
  if (kept.ok()) kept = blobs.put(task.result, task.bytes);
  if (kept.ok()) return std::move(task.bytes);
  if (absl::IsInvalidArgument(kept)) return kept;
  // The disk's trouble, not the worker's. It hears of it, and goes on trying, where it uploads.
  task.bytes.clear();
  return make_status(absl::StatusCode::kNotFound, "{}", message_of(kept));
}

/// Keeps a result's bytes and reads them: they must be whole, finite, and of one rectangle.
absl::StatusOr<ResultShape> shape_of(const BlobFolder& blobs, const BlobLimits& limits, CompletedTask& task) {
  if (task.result.empty()) return ResultShape{};  // a pilot; the scheduler refuses it for anything else
  ASSIGN_OR_RETURN(std::string bytes, bytes_of(blobs, limits, task));
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
  SyncCall(Coordinator& coordinator, const BlobLimits& limits, const v1::SyncRequest& request,
           v1::SyncResponse& response)
      : coordinator_(coordinator) {
    ticket_ = coordinator.new_ticket();
    absl::StatusOr<WorkerState> state = from_proto(request);
    if (!state.ok()) {
      Finish(to_grpc(state.status()));
      return;
    }
    std::vector<absl::StatusOr<ResultShape>> shapes;
    for (CompletedTask& task : state->completed)
      shapes.push_back(shape_of(coordinator.blobs(), limits, task));
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
  return new SyncCall(coordinator_, limits_, *request, *response);
}

}  // namespace penumbra

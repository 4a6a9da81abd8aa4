#pragma once
#include "proto/worker.grpc.pb.h"
#include "server/blob_transfer.h"
#include "server/coordinator.h"

namespace penumbra {

/// proto/worker.proto over the coordinator. Uses gRPC's callbacks, so that thousands of waiting workers
/// hold no thread.
class WorkerService final : public v1::Worker::CallbackService {
 public:
  WorkerService(Coordinator& coordinator, const BlobLimits& limits)
      : coordinator_(coordinator), limits_(limits) {}

  grpc::ServerUnaryReactor* Sync(grpc::CallbackServerContext*, const v1::SyncRequest* request,
                                 v1::SyncResponse* response) override;

 private:
  Coordinator& coordinator_;
  BlobLimits limits_;
};

}  // namespace penumbra

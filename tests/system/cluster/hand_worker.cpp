#include "tests/system/cluster/hand_worker.h"

#include <gtest/gtest.h>

#include "proto/convert.h"
#include "proto/rpc_status.h"

namespace penumbra {

HandWorker::HandWorker(Cluster& cluster, const std::string& name) : cluster_(cluster) {
  state.version = "by hand";
  state.worker = {name + "-incarnation", "host-" + name, "avx2", 1};
  state.name = name;
}

absl::StatusOr<DesiredState> HandWorker::say(const WorkerState& told) {
  grpc::ClientContext context;
  v1::SyncResponse response;
  const grpc::Status status = cluster_.workers_stub().Sync(&context, to_proto(told), &response);
  if (!status.ok()) return from_grpc(status);
  return from_proto(response);
}

std::vector<DesiredLease> HandWorker::take(uint32_t wanted) {
  state.wanted = wanted;
  const auto answer = say(state);
  EXPECT_TRUE(answer.ok()) << answer.status();
  std::vector<DesiredLease> fresh;
  if (!answer.ok()) return fresh;
  for (const DesiredLease& lease : answer->leases)
    if (lease.task) fresh.push_back(lease);
  for (const DesiredLease& lease : fresh) state.held.push_back({lease.lease, true});
  return fresh;
}

CompletedTask HandWorker::result_of(const DesiredLease& lease, const std::string& bytes) {
  const Digest digest = sha256(bytes);
  const grpc::Status status = cluster_.upload(digest, bytes);
  EXPECT_TRUE(status.ok()) << status.error_message();
  CompletedTask done{lease.lease, digest, {}};
  for (const PassRange& range : lease.task->passes) done.costs.push_back({range.count(), 0.01, 1, 1, 0, 0});
  return done;
}

std::string flat_result(const TileTask& task, float value) {
  TileResult result;
  for (const PassRange& range : task.passes) {
    TilePixels pixels;
    pixels.rect = task.tile;
    pixels.passes = pixels.groups = range.count();
    const auto n = static_cast<size_t>(task.tile.area());
    pixels.mean.assign(3 * n, value);
    pixels.m2.assign(3 * n, value);
    pixels.cost.assign(n, value);
    result.mixes.push_back(std::move(pixels));
  }
  return serialize(result);
}

}  // namespace penumbra

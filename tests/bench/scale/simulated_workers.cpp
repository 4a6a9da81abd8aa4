#include "tests/bench/scale/simulated_workers.h"

#include <fmt/format.h>
#include <grpcpp/create_channel.h>

#include <chrono>

#include "film/tile_pixels.h"
#include "proto/channel.h"
#include "proto/convert.h"
#include "proto/sha256.h"

namespace penumbra {
namespace {

constexpr uint32_t kLeases = 2, kWaitMilliseconds = 4000;

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

/// One call at a time, as the real one; only its own callbacks and one uploader at a time touch it.
struct SimulatedWorkers::Worker {
  WorkerState state;
  std::vector<DesiredLease> fresh;
  size_t number = 0;
  std::unique_ptr<grpc::ClientContext> context;
  v1::SyncRequest request;
  v1::SyncResponse response;
};

SimulatedWorkers::SimulatedWorkers(const SimulationOptions& options) : options_(options) {
  for (int i = 0; i < options_.channels; ++i) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // else all channels are one connection
    const auto channel =
        grpc::CreateCustomChannel(options_.address, grpc::InsecureChannelCredentials(), arguments);
    stubs_.push_back(v1::Worker::NewStub(channel));
    blobs_.push_back(v1::Blobs::NewStub(channel));
  }
  for (int i = 0; i < options_.uploaders; ++i) uploaders_.emplace_back([this] { upload_loop(); });
  for (int i = 0; i < options_.workers; ++i) {
    auto worker = std::make_unique<Worker>();
    worker->number = static_cast<size_t>(i);
    worker->state.version = "simulated";
    worker->state.name = fmt::format("{}", i);
    worker->state.worker = {fmt::format("incarnation-{}", i), fmt::format("host-{}", i), "avx2", 1};
    worker->state.wanted = kLeases;
    workers_.push_back(std::move(worker));
  }
  for (const auto& worker : workers_) sync(*worker);
}

SimulatedWorkers::~SimulatedWorkers() {
  stopping_ = true;
  ready_.notify_all();
  for (std::thread& thread : uploaders_) thread.join();
  while (calls_ > 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

void SimulatedWorkers::sync(Worker& worker) {
  if (stopping_) return;
  worker.state.wait_milliseconds = worker.state.completed.empty() ? kWaitMilliseconds : 0;
  worker.request = to_proto(worker.state);
  worker.response.Clear();
  worker.context = std::make_unique<grpc::ClientContext>();
  ++calls_;
  ++counts_.syncs;
  stubs_[worker.number % stubs_.size()]->async()->Sync(
      worker.context.get(), &worker.request, &worker.response, [this, &worker](const grpc::Status& status) {
        answered(worker, status);
        --calls_;
      });
}

void SimulatedWorkers::answered(Worker& worker, const grpc::Status& status) {
  const auto desired =
      status.ok() ? from_proto(worker.response) : absl::StatusOr<DesiredState>(absl::CancelledError());
  if (!desired.ok()) {
    ++counts_.failed_syncs;
    return sync(worker);
  }
  counts_.accepted += desired->acknowledged.size();
  worker.state.completed.clear();
  worker.state.known_jobs.clear();
  for (const DesiredLease& lease : desired->leases)
    if (lease.task) worker.fresh.push_back(lease);
  if (worker.fresh.empty()) return sync(worker);
  counts_.leases += worker.fresh.size();
  const std::lock_guard lock(mutex_);
  due_.push_back({steady_seconds() + options_.task_seconds, &worker});
  ready_.notify_one();
}

void SimulatedWorkers::upload_loop() {
  while (!stopping_) {
    Due next{};
    {
      std::unique_lock lock(mutex_);
      ready_.wait_for(lock, std::chrono::milliseconds(100), [&] { return stopping_ || !due_.empty(); });
      if (due_.empty()) continue;
      next = due_.front();
      due_.pop_front();
    }
    while (steady_seconds() < next.at && !stopping_)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (const DesiredLease& lease : std::exchange(next.worker->fresh, {})) finish(*next.worker, lease);
    sync(*next.worker);
  }
}

void SimulatedWorkers::finish(Worker& worker, const DesiredLease& lease) {
  const std::string bytes = result_of(*lease.task);
  CompletedTask done{lease.lease, sha256(bytes), {}, {}, {}};
  if (bytes.size() > kMostBytesAlong)
    upload(*blobs_[worker.number % blobs_.size()], done.result, bytes);
  else
    done.bytes = bytes;
  counts_.result_bytes += bytes.size();
  for (const PassRange& range : lease.task->passes) done.costs.push_back({range.count(), 0.1, 100, 10, 0, 0});
  worker.state.completed.push_back(std::move(done));
}

void SimulatedWorkers::upload(v1::Blobs::Stub& blobs, const Digest& digest, const std::string& bytes) {
  grpc::ClientContext context;
  v1::UploadResponse response;
  const auto writer = blobs.Upload(&context, &response);
  v1::UploadChunk chunk;
  chunk.set_digest(digest);
  chunk.set_size(bytes.size());
  chunk.set_flush_later(true);
  for (size_t at = 0; at == 0 || at < bytes.size(); at += kChunkBytes) {
    chunk.set_data(bytes.substr(at, kChunkBytes));
    writer->Write(chunk);
    chunk.Clear();
  }
  writer->WritesDone();
  if (!writer->Finish().ok()) ++counts_.failed_syncs;
}

/// No two alike, or the store would keep one.
std::string SimulatedWorkers::result_of(const TileTask& task) {
  TileResult result;
  const auto n = static_cast<size_t>(task.tile.area());
  const auto serial = static_cast<float>(serial_++);
  for (const PassRange& range : task.passes) {
    TilePixels pixels{task.tile, range.count(), range.count(), {}, {}, {}};
    pixels.mean.assign(3 * n, serial);
    pixels.m2.assign(3 * n, 0.5F);
    pixels.cost.assign(n, 1.0F);
    result.mixes.push_back(std::move(pixels));
  }
  return serialize(result);
}

}  // namespace penumbra

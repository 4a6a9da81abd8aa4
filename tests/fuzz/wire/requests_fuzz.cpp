// Any sequence of requests of every RPC, through what the services hand them to: blobs, jobs, a worker's
// reports, and time that passes in between. Whatever callers say, the server's laws hold, and what it answers
// is what its callers' own checks accept.
//
// An input is a list of steps: a byte says which, a byte how long its bytes are, then these.
#include <google/protobuf/stubs/logging.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>

#include "proto/blocks.h"
#include "proto/convert.h"
#include "proto/status.h"
#include "scenes/bundle.h"
#include "server/blob_transfer.h"
#include "server/job_report.h"
#include "server/planner.h"
#include "server/scheduler.h"
#include "server/submission.h"

namespace penumbra {
namespace {

// Larger jobs take longer, and nothing else: their numbers are checked before.
constexpr uint64_t kMostTilesHere = 4;
constexpr int64_t kMostPixels = 64 * 64;
constexpr size_t kMostJobs = 4;
constexpr BlobLimits kLimits{1 << 10, 0};

/// A folder with a bundle of one empty file, on a disk of memory where there is one.
class Blobs {
 public:
  Blobs() {
    const char* memory = std::filesystem::exists("/dev/shm") ? "/dev/shm" : "/tmp";
    std::string name = fmt::format("{}/penumbra-fuzz-XXXXXX", memory);
    PENUMBRA_CHECK(::mkdtemp(name.data()) != nullptr);
    root_ = name;
    folder_ = std::make_unique<BlobFolder>(BlobFolder::open(root_, Durability::kProcessEnd).value());
    BundleIndex index;
    index.main = "s";
    index.entries = {{"s", "s", sha256(""), 0}};
    const std::string json = serialize(index);
    bundle = sha256(json);
    PENUMBRA_CHECK(folder_->put(sha256(""), "").ok() && folder_->put(bundle, json).ok());
  }
  ~Blobs() { std::filesystem::remove_all(root_); }
  const BlobFolder& folder() const { return *folder_; }
  /// As it was before an upload.
  void restore(const Digest& digest) const {
    if (digest != bundle && digest != sha256("")) folder_->remove(digest);
    // Whatever was kept of it: an upload of nothing at all ends it.
    if (const auto writer = folder_->write(digest, 0, 0); writer.ok()) (*writer)->discard();
  }
  Digest bundle;

 private:
  std::string root_;
  std::unique_ptr<BlobFolder> folder_;
};

class Server {
 public:
  explicit Server(const Blobs& blobs) : blobs_(blobs) {}

  void submit(v1::SubmitRequest request) {
    // The digest of what is there would be too much to ask of a fuzzer.
    if (request.spec().bundle() == "b") request.mutable_spec()->set_bundle(blobs_.bundle);
    const absl::StatusOr<JobSpec> spec = checked_spec(blobs_.folder(), request);
    const absl::StatusOr<JobTerms> terms = from_proto(request.terms());
    if (!spec.ok() || !terms.ok()) return;
    if (tile_count(*spec) > kMostTilesHere || spec->crop.area() > kMostPixels || jobs_ == kMostJobs) return;
    if (!scheduler_.check_quota(terms->user).ok()) return;
    scheduler_.submit(fmt::format("j{}", jobs_++), request.request_id(), *spec, now_, *terms);
  }

  void ask(const v1::JobRequest& request) { tell(scheduler_.find(request.job())); }
  void cancel(const v1::JobRequest& request) {
    PENUMBRA_CHECK(scheduler_.cancel(request.job(), now_).ok() ==
                   (scheduler_.find(request.job()) != nullptr));
  }
  void list(const v1::ListJobsRequest&) {
    for (const auto& [id, job] : scheduler_.jobs()) tell(job.get());
  }
  void log(const v1::LogRequest& request) {
    const JobRecord* job = scheduler_.find(request.job());
    if (job == nullptr || (request.has_tile() && !job->check_tile(request.tile()).ok())) return;
    for (const LogLine& line : job->log) PENUMBRA_CHECK(from_proto(to_proto(line)).ok());
  }
  void fetch(const v1::FetchFramesRequest& request) {
    const JobRecord* job = scheduler_.find(request.job());
    if (job == nullptr) return;
    const RunSummary summary = summary_of(scheduler_, *job, now_);
    const auto heard = from_proto(to_proto(summary));
    PENUMBRA_CHECK(heard.ok() && *heard == summary);
  }

  void sync(const v1::SyncRequest& request) {
    const absl::StatusOr<WorkerState> state = from_proto(request);
    if (state.ok()) report(*state);
  }

  /// A worker that does what it is told, but for what it says that its tasks have cost: the bytes are
  /// doubles.
  void work(const uint8_t* bytes, size_t count) {
    v1::SyncRequest request = to_proto(worker_);
    const auto amount = [&] {
      double value = 0.125;
      if (count < sizeof value) return value;
      std::memcpy(&value, bytes, sizeof value);
      bytes += sizeof value;
      count -= sizeof value;
      return value;
    };
    for (v1::SyncRequest::Completed& task : *request.mutable_completed()) {
      for (v1::MixCost& cost : *task.mutable_costs()) {
        cost.set_cpu_seconds(amount());
        cost.set_relative_variance(amount());
        cost.set_relative_variance_squares(amount());
        cost.set_work(amount());
        if (cost.repilot_passes() > 0) cost.set_repilot_seconds(amount());
        for (v1::BlockCost& block : *cost.mutable_blocks()) {
          block.set_relative_deviation(static_cast<float>(amount()));
          block.set_cpu_seconds(static_cast<float>(amount()));
        }
      }
    }
    const absl::StatusOr<WorkerState> state = from_proto(request);
    if (!state.ok()) return;
    const std::optional<DesiredState> desired = report(*state);
    if (!desired) return;
    worker_.held.clear();
    worker_.completed.clear();
    for (const DesiredLease& lease : desired->leases) worker_.completed.push_back(done(lease.lease));
  }

  void pass(double seconds) {
    now_.steady += seconds;
    now_.unix_time += seconds;
    scheduler_.expire(now_);
  }

  void lose(size_t which) {
    if (which >= jobs_) return;
    const JobId id = fmt::format("j{}", which);
    const JobRecord* job = scheduler_.find(id);
    if (job == nullptr) return;
    std::vector<std::pair<uint64_t, Digest>> lost;
    for (uint64_t task = 0; task < job->results().size(); ++task)
      if (const auto& result = job->results()[task]) lost.emplace_back(task, result->result);
    scheduler_.lose_results(id, lost, now_);
  }

  void forget(size_t which) { scheduler_.forget(fmt::format("j{}", which)); }

  void rest() {
    scheduler_.take_changes();
    scheduler_.take_notices();
  }

 private:
  void tell(const JobRecord* job) {
    if (job == nullptr) return;
    const JobStatus status = status_of(scheduler_, *job, now_);
    const auto heard = from_proto(to_proto(status));
    PENUMBRA_CHECK(heard.ok() && *heard == status);
    PENUMBRA_CHECK(status.tasks_done + status.tasks_leased <= status.tasks_total || job->final());
    PENUMBRA_CHECK(!explain(scheduler_, *job, now_).empty());
  }

  std::optional<DesiredState> report(const WorkerState& state) {
    std::vector<absl::StatusOr<ResultShape>> shapes;
    for (const CompletedTask& task : state.completed) shapes.push_back(shape_of(task));
    if (!scheduler_.report(state, shapes, now_).ok()) return std::nullopt;
    const DesiredState desired = scheduler_.answer(state, now_).desired;
    for (const DesiredLease& lease : desired.leases)
      if (lease.task) tasks_[lease.lease] = *lease.task;
    const auto heard = from_proto(to_proto(desired));
    PENUMBRA_CHECK(heard.ok() && *heard == desired);
    return desired;
  }

  /// What the bytes would hold that a sound worker has uploaded; for anything else they are not here.
  absl::StatusOr<ResultShape> shape_of(const CompletedTask& done) const {
    const auto found = tasks_.find(done.lease);
    if (found == tasks_.end() || done.result.empty()) return ResultShape{};
    if (done.result != blobs_.bundle) return absl::NotFoundError("no such blob");
    const TileTask& task = found->second;
    ResultShape shape{task.tile, {}};
    for (size_t m = 0; m < task.passes.size(); ++m) {
      const PassRange& range = task.passes[m];
      shape.passes.push_back(range.count());
      shape.bins.push_back(bins_of(done.lease.job));
      std::vector<int32_t>& blocks = shape.block_passes.emplace_back();
      for (const ChosenMix& chosen : task.chosen) {
        if (chosen.mix != static_cast<int>(m)) continue;
        for (const uint8_t share : chosen.shares)
          blocks.push_back(static_cast<int32_t>(passes_of_block(range.end, share, chosen.group) -
                                                passes_of_block(range.begin, share, chosen.group)));
      }
    }
    return shape;
  }
  int bins_of(const JobId& id) const {
    const JobRecord* job = scheduler_.find(id);
    return job != nullptr && job->spec().transient ? job->spec().transient->bins : 0;
  }

  CompletedTask done(const LeaseId& lease) const {
    CompletedTask done{lease, {}, {}, {}};
    const auto found = tasks_.find(lease);
    if (found == tasks_.end()) return done;
    const TileTask& task = found->second;
    if (task.kind == TaskKind::kRun) done.result = blobs_.bundle;
    done.costs.resize(costs_of(task));
    for (size_t m = 0; m < done.costs.size(); ++m) {
      MixCost& cost = done.costs[m];
      cost.passes = m < task.passes.size() ? task.passes[m].count() : 2;
      cost.rays = 1;
      cost.pixels = 16;
      if (m < task.repilot.size()) cost.repilot_passes = task.repilot[m].count();
      if (task.kind == TaskKind::kPilot && m < task.passes.size() && !task.chosen.empty())
        cost.blocks.resize(block_count(task.tile));
    }
    return done;
  }

  const Blobs& blobs_;
  Scheduler scheduler_;
  Now now_{100, 1e9, 0};
  size_t jobs_ = 0;
  std::map<LeaseId, TileTask> tasks_;  ///< all that was ever given out
  WorkerState worker_{"v", {"w", "h", "avx2", 8}, "0", {}, {}, {}, {}, 8};
};

/// One blob: what was uploaded can be had again, and nothing else.
class Upload {
 public:
  explicit Upload(const Blobs& blobs) : blobs_(blobs) {}
  ~Upload() {
    for (const Digest& digest : written_) blobs_.restore(digest);
  }
  void add(v1::UploadChunk chunk) { chunks_.push_back(std::move(chunk)); }
  void end() {
    if (!chunks_.empty()) {
      std::string bytes;
      for (const v1::UploadChunk& chunk : chunks_) bytes += chunk.data();
      if (chunks_[0].digest() == "b") chunks_[0].set_digest(sha256(bytes));  // as in Server::submit
      if (is_digest(chunks_[0].digest())) written_.push_back(chunks_[0].digest());
    }
    size_t next = 0;
    const auto size = receive_blob(blobs_.folder(), kLimits, [&](v1::UploadChunk& chunk) {
      if (next == chunks_.size()) return false;
      chunk = chunks_[next++];
      return true;
    });
    if (size.ok()) {
      v1::DownloadRequest request;
      request.set_digest(chunks_[0].digest());
      PENUMBRA_CHECK(check(request).ok());
    }
    chunks_.clear();
  }
  absl::Status check(const v1::DownloadRequest& request) const {
    std::string bytes;
    const absl::Status sent = send_blob(blobs_.folder(), request, [&](const v1::DownloadChunk& chunk) {
      bytes += chunk.data();
      return true;
    });
    if (sent.ok() && request.offset() == 0) PENUMBRA_CHECK(sha256(bytes) == request.digest());
    return sent;
  }

 private:
  const Blobs& blobs_;
  std::vector<v1::UploadChunk> chunks_;
  std::vector<Digest> written_;
};

template <class Message, class Use>
void with(const uint8_t* bytes, size_t count, Use use) {
  Message message;
  if (message.ParseFromArray(bytes, static_cast<int>(count))) use(message);
}

void step(Server& server, Upload& upload, const Blobs& blobs, uint8_t kind, const uint8_t* b, size_t n) {
  using namespace v1;
  switch (kind % 14) {
    case 0:
      return with<SubmitRequest>(b, n, [&](const SubmitRequest& r) { server.submit(r); });
    case 1:  // GetJob, Watch, Explain
      return with<JobRequest>(b, n, [&](const JobRequest& r) { server.ask(r); });
    case 2:
      return with<JobRequest>(b, n, [&](const JobRequest& r) { server.cancel(r); });
    case 3:
      return with<ListJobsRequest>(b, n, [&](const ListJobsRequest& r) { server.list(r); });
    case 4:
      return with<LogRequest>(b, n, [&](const LogRequest& r) { server.log(r); });
    case 5:
      return with<FetchFramesRequest>(b, n, [&](const FetchFramesRequest& r) { server.fetch(r); });
    case 6:
      return with<SyncRequest>(b, n, [&](const SyncRequest& r) { server.sync(r); });
    case 7:
      return with<FindMissingRequest>(b, n, [&](const FindMissingRequest& r) {
        const auto missing = missing_blobs(blobs.folder(), r);
        if (missing.ok()) PENUMBRA_CHECK(missing->missing_size() <= r.digests_size());
      });
    case 8:
      return with<UploadChunk>(b, n, [&](const UploadChunk& r) { upload.add(r); });
    case 9:
      return upload.end();
    case 10:
      return with<DownloadRequest>(b, n,
                                   [&](const DownloadRequest& r) { static_cast<void>(upload.check(r)); });
    case 11:
      return server.work(b, n);
    case 12:
      return server.pass(n);
    default:
      return n % 2 == 0 ? server.lose(n / 2) : server.forget(n / 2);
  }
}

}  // namespace
}  // namespace penumbra

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t count) {
  using namespace penumbra;
  static const Blobs blobs;
  google::protobuf::SetLogHandler(
      nullptr);  // text that is no text is refused; a line of each would take longest
  Server server(blobs);
  Upload upload(blobs);
  while (count > 1) {
    const size_t size = std::min<size_t>(bytes[1], count - 2);
    step(server, upload, blobs, bytes[0], bytes + 2, size);
    server.rest();
    bytes += size + 2;
    count -= size + 2;
  }
  return 0;
}

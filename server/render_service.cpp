#include "server/render_service.h"

#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "proto/convert.h"
#include "proto/rpc_status.h"
#include "server/assembler.h"
#include "server/caller.h"
#include "server/frame_stream.h"
#include "server/job_report.h"
#include "server/submission.h"

namespace penumbra {
namespace {

// A watcher hears of changes at most this often, and of nothing this seldom.
constexpr double kLeastWatchSeconds = 0.2, kMostWatchSeconds = 5;
// A job whose lost results are rendered again and that makes no progress for so long has no workers.
constexpr double kMostQuietSeconds = 5;
// Frames of one fetch that are kept in memory at a time.
constexpr uint64_t kAssemblyBytes = uint64_t{1} << 30;

/// Short and printable; needs only to be unlikely to repeat (submit checks the store's).
JobId new_job_id() {
  std::random_device device;
  const uint64_t bits = (uint64_t{device()} << 32) | device();
  return fmt::format("j{:010x}", bits & 0xff'ffff'ffffu);
}

absl::Status no_job(const JobId& id) {
  return make_status(absl::StatusCode::kNotFound, "no job {:.80}", id);
}

/// Flattens what call() returns: the coordinator's error or the work's.
template <class T>
absl::StatusOr<T> flat(absl::StatusOr<absl::StatusOr<T>> nested) {
  if (!nested.ok()) return nested.status();
  return *std::move(nested);
}

// Of what workers logged: bytes that are read and sent, well below kMostMessageBytes.
constexpr size_t kMostLogBytes = 8 << 20;

/// A worker's text comes when its task has come to an end: its lines stand before what became of it.
void add_worker_lines(const std::vector<PutLog>& logs, std::vector<LogLine>& lines) {
  size_t first = logs.size();
  for (size_t bytes = 0; first > 0; --first) {
    // A line repeats the worker's name; few are shorter than 16 characters.
    bytes += logs[first - 1].text.size() * (1 + logs[first - 1].worker.size() / 16);
    if (bytes > kMostLogBytes) break;
  }
  std::vector<LogLine> all;
  for (size_t i = first; i < logs.size(); ++i) {
    std::istringstream in(logs[i].text);
    for (std::string line; std::getline(in, line);)
      all.push_back({logs[i].unix_time, logs[i].lease.task, logs[i].worker, "| " + line});
  }
  all.insert(all.end(), lines.begin(), lines.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const LogLine& a, const LogLine& b) { return a.unix_seconds < b.unix_seconds; });
  lines = std::move(all);
}

double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

grpc::Status RenderService::Submit(grpc::ServerContext* context, const v1::SubmitRequest* request,
                                   v1::SubmitResponse* response) {
  const absl::StatusOr<JobSpec> spec = checked_spec(coordinator_.blobs(), *request);
  if (!spec.ok()) return to_grpc(spec.status());
  absl::StatusOr<JobTerms> terms = from_proto(request->terms());
  if (!terms.ok()) return to_grpc(terms.status());
  if (const Caller caller = caller_of(*context); caller.known) terms->user = caller.user;
  // What the job needs must outlive the power before the job does. Uploads made their blobs durable.
  const auto id = flat(coordinator_.call([&](Scheduler& scheduler, const Now& now) -> absl::StatusOr<JobId> {
    if (const JobId* made = scheduler.find_request(request->request_id())) return *made;
    for (const JobId& before : terms->after) {
      const JobRecord* job = scheduler.find(before);
      if (job == nullptr) return invalid_input("after: no job {}", before);
      if (job->final() && job->header.state != JobState::kDone)
        return invalid_input("after: job {} is {}", before, name_of(job->header.state));
    }
    RETURN_IF_ERROR(scheduler.check_quota(terms->user));
    JobId fresh = new_job_id();
    while (scheduler.find(fresh) != nullptr) fresh = new_job_id();
    return scheduler.submit(fresh, request->request_id(), *spec, now, *terms);
  }));
  if (!id.ok()) return to_grpc(id.status());
  response->set_job(*id);
  return grpc::Status::OK;
}

absl::StatusOr<JobStatus> RenderService::status(const JobId& id) {
  return flat(coordinator_.call([&](Scheduler& scheduler, const Now& now) -> absl::StatusOr<JobStatus> {
    const JobRecord* job = scheduler.find(id);
    if (job == nullptr) return no_job(id);
    return status_of(scheduler, *job, now);
  }));
}

grpc::Status RenderService::GetJob(grpc::ServerContext*, const v1::JobRequest* request,
                                   v1::JobStatus* response) {
  const absl::StatusOr<JobStatus> found = status(request->job());
  if (!found.ok()) return to_grpc(found.status());
  *response = to_proto(*found);
  return grpc::Status::OK;
}

grpc::Status RenderService::Watch(grpc::ServerContext* context, const v1::JobRequest* request,
                                  grpc::ServerWriter<v1::JobStatus>* writer) {
  uint64_t revision = 0;
  for (;;) {
    // Taken before the status: a change in between is told again, never missed.
    revision = coordinator_.wait_for_change(revision, 0);
    const absl::StatusOr<JobStatus> found = status(request->job());
    if (!found.ok()) return to_grpc(found.status());
    if (!writer->Write(to_proto(*found))) return grpc::Status::CANCELLED;
    if (is_final(found->state)) return grpc::Status::OK;
    std::this_thread::sleep_for(std::chrono::duration<double>(kLeastWatchSeconds));
    // A watcher that has hung up is noticed within a second.
    for (double waited = kLeastWatchSeconds; waited < kMostWatchSeconds; waited += 1) {
      if (context->IsCancelled()) return grpc::Status::CANCELLED;
      if (coordinator_.wait_for_change(revision, 1) != revision) break;
    }
  }
}

grpc::Status RenderService::ListJobs(grpc::ServerContext*, const v1::ListJobsRequest*,
                                     v1::ListJobsResponse* response) {
  auto jobs = coordinator_.call([](Scheduler& scheduler, const Now& now) {
    std::vector<JobStatus> all;
    for (const auto& [id, job] : scheduler.jobs()) all.push_back(status_of(scheduler, *job, now));
    return all;
  });
  if (!jobs.ok()) return to_grpc(jobs.status());
  std::stable_sort(jobs->begin(), jobs->end(), [](const JobStatus& a, const JobStatus& b) {
    return a.submitted_unix_seconds > b.submitted_unix_seconds;
  });
  for (const JobStatus& job : *jobs) *response->add_jobs() = to_proto(job);
  return grpc::Status::OK;
}

grpc::Status RenderService::Cancel(grpc::ServerContext* context, const v1::JobRequest* request,
                                   v1::JobStatus* response) {
  const Caller caller = caller_of(*context);
  const auto found =
      flat(coordinator_.call([&](Scheduler& scheduler, const Now& now) -> absl::StatusOr<JobStatus> {
        const JobRecord* job = scheduler.find(request->job());
        if (job != nullptr && !caller.may_touch(job->header.terms.user))
          return make_status(absl::StatusCode::kPermissionDenied,
                             "job {} is user {}'s; cancelling it takes an admin", request->job(),
                             job->header.terms.user);
        RETURN_IF_ERROR(scheduler.cancel(request->job(), now));
        return status_of(scheduler, *scheduler.find(request->job()), now);
      }));
  if (!found.ok()) return to_grpc(found.status());
  *response = to_proto(*found);
  return grpc::Status::OK;
}

grpc::Status RenderService::Explain(grpc::ServerContext*, const v1::JobRequest* request,
                                    v1::ExplainResponse* response) {
  const auto reasons = flat(coordinator_.call(
      [&](Scheduler& scheduler, const Now& now) -> absl::StatusOr<std::vector<std::string>> {
        const JobRecord* job = scheduler.find(request->job());
        if (job == nullptr) return no_job(request->job());
        return explain(scheduler, *job, now);
      }));
  if (!reasons.ok()) return to_grpc(reasons.status());
  for (const std::string& reason : *reasons) response->add_reasons(reason);
  return grpc::Status::OK;
}

grpc::Status RenderService::Log(grpc::ServerContext*, const v1::LogRequest* request,
                                v1::LogResponse* response) {
  std::optional<uint64_t> tile;
  if (request->has_tile()) tile = request->tile();
  auto lines =
      flat(coordinator_.call([&](Scheduler& scheduler, const Now&) -> absl::StatusOr<std::vector<LogLine>> {
        const JobRecord* job = scheduler.find(request->job());
        if (job == nullptr) return no_job(request->job());
        if (tile) RETURN_IF_ERROR(job->check_tile(*tile));
        std::vector<LogLine> kept(job->log.begin(), job->log.end());
        if (tile)
          std::erase_if(kept, [&](const LogLine& l) { return !l.task || job->tile_of(*l.task) != *tile; });
        return kept;
      }));
  if (!lines.ok()) return to_grpc(lines.status());
  if (request->worker_lines()) {
    const auto logs = coordinator_.worker_logs(request->job(), tile, kMostLogBytes);
    if (!logs.ok()) return to_grpc(logs.status());
    add_worker_lines(*logs, *lines);
  }
  for (const LogLine& line : *lines) *response->add_lines() = to_proto(line);
  return grpc::Status::OK;
}

/// What the disk has not kept is rendered again. Waits for that as long as the caller does and something
/// happens; Unavailable in any case, because what was sent until now must be asked for anew.
absl::Status RenderService::restore_lost(const JobId& id, const Assembly& assembly,
                                         const grpc::ServerContext& context) {
  const auto lost = lost_results(assembly, coordinator_.blobs());
  const auto count = coordinator_.call([&](Scheduler& scheduler, const Now& now) {
    scheduler.lose_results(id, lost, now);
    return lost.size();
  });
  RETURN_IF_ERROR(count.status());
  uint64_t done = 0;
  for (double quiet = 0; quiet < kMostQuietSeconds && !context.IsCancelled(); quiet += kLeastWatchSeconds) {
    ASSIGN_OR_RETURN(const JobStatus now, status(id));
    if (is_final(now.state)) break;
    if (std::exchange(done, now.tasks_done) != now.tasks_done) quiet = 0;
    std::this_thread::sleep_for(std::chrono::duration<double>(kLeastWatchSeconds));
  }
  return make_status(absl::StatusCode::kUnavailable,
                     "job {}: the server's disk has not kept {} results; they are rendered again", id,
                     *count);
}

grpc::Status RenderService::FetchFrames(grpc::ServerContext* context, const v1::FetchFramesRequest* request,
                                        grpc::ServerWriter<v1::FetchFramesResponse>* writer) {
  struct Taken {
    RunSummary summary;
    Assembly assembly;
    double scheduler_cpu_seconds;
  };
  const double started = thread_cpu_seconds();
  const auto taken =
      flat(coordinator_.call([&](Scheduler& scheduler, const Now& now) -> absl::StatusOr<Taken> {
        const JobRecord* job = scheduler.find(request->job());
        if (job == nullptr) return no_job(request->job());
        return Taken{summary_of(scheduler, *job, now), assembly_of(*job), scheduler_cpu_seconds(*job, now)};
      }));
  if (!taken.ok()) return to_grpc(taken.status());
  FrameStream stream(*writer);
  absl::Status status = stream.summary(taken->summary);
  if (status.ok() && !request->summary_only())
    status = assemble(taken->assembly, coordinator_.blobs(), request->checkpoints(), kAssemblyBytes,
                      [&](const AssembledFrame& frame) { return stream.frame(frame); });
  if (absl::IsDataLoss(status) || absl::IsNotFound(status))
    status = restore_lost(request->job(), taken->assembly, *context);
  if (status.ok()) status = stream.end(taken->scheduler_cpu_seconds + thread_cpu_seconds() - started);
  return to_grpc(status);
}

}  // namespace penumbra

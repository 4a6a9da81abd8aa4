#include "server/retention.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <unordered_set>

#include "proto/status.h"
#include "scenes/bundle.h"

namespace penumbra {
namespace {

// Between sweeps; shorter where jobs are kept for less.
constexpr double kMostPauseSeconds = 60, kLeastPauseSeconds = 1;

struct KeptJob {
  JobId id;
  Digest bundle;
  bool final = false;
  double finished_unix = 0;
  std::vector<Digest> results;
};

struct Taken {
  std::vector<KeptJob> jobs;
  double unix_time = 0;
};

absl::StatusOr<Taken> take_jobs(Coordinator& coordinator) {
  return coordinator.call([](Scheduler& scheduler, const Now& now) {
    Taken taken;
    taken.unix_time = now.unix_time;
    for (const auto& [id, job] : scheduler.jobs()) {
      KeptJob kept{id, job->spec().bundle, job->final(), job->header.finished_unix, {}};
      for (const auto& result : job->results())
        if (result && !result->result.empty()) kept.results.push_back(result->result);
      taken.jobs.push_back(std::move(kept));
    }
    return taken;
  });
}

/// Everything that the jobs name: bundles' indices, what those name, results.
std::unordered_set<Digest> named_by(const std::vector<KeptJob>& jobs, const BlobFolder& blobs) {
  std::unordered_set<Digest> named;
  for (const KeptJob& job : jobs) {
    named.insert(job.results.begin(), job.results.end());
    if (!named.insert(job.bundle).second) continue;
    const auto json = blobs.read(job.bundle);
    if (!json.ok()) continue;  // the job that needs it will say so
    const auto index = parse_bundle_index(*json);
    if (!index.ok()) continue;
    for (const BundleEntry& entry : index->entries) named.insert(entry.digest);
  }
  return named;
}

uint64_t bytes_of(const KeptJob& job, const BlobFolder& blobs) {
  uint64_t bytes = 0;
  for (const Digest& digest : job.results) bytes += blobs.size(digest).value_or(0);
  return bytes;
}

/// The jobs that must go, oldest first. Only results count: a scene's files outlive its jobs anyway, so that
/// forgetting a job would not make room for them.
std::vector<JobId> overdue_jobs(const Taken& taken, const BlobFolder& blobs, const RetentionLimits& limits) {
  uint64_t bytes = 0;
  for (const KeptJob& job : taken.jobs) bytes += bytes_of(job, blobs);
  std::vector<const KeptJob*> finished;
  for (const KeptJob& job : taken.jobs)
    if (job.final) finished.push_back(&job);
  std::sort(finished.begin(), finished.end(),
            [](const KeptJob* a, const KeptJob* b) { return a->finished_unix < b->finished_unix; });
  std::vector<JobId> out;
  for (const KeptJob* job : finished) {
    const bool old = taken.unix_time - job->finished_unix >= limits.keep_seconds;
    if (!old && bytes <= limits.keep_bytes) continue;
    bytes -= std::min(bytes, bytes_of(*job, blobs));
    out.push_back(job->id);
  }
  return out;
}

}  // namespace

absl::StatusOr<Swept> sweep(Coordinator& coordinator, const RetentionLimits& limits) {
  const BlobFolder& blobs = coordinator.blobs();
  blobs.drop_stale_partials();
  Swept swept;
  ASSIGN_OR_RETURN(const Taken before, take_jobs(coordinator));
  const std::vector<JobId> overdue = overdue_jobs(before, blobs, limits);
  const auto forgotten = coordinator.call([&](Scheduler& scheduler, const Now&) {
    for (const JobId& id : overdue) scheduler.forget(id);
    return overdue.size();
  });
  RETURN_IF_ERROR(forgotten.status());
  swept.jobs = *forgotten;

  ASSIGN_OR_RETURN(const Taken after, take_jobs(coordinator));
  const std::unordered_set<Digest> named = named_by(after.jobs, blobs);
  std::unordered_set<Digest> dropped;  // results of the forgotten jobs need not wait
  for (const KeptJob& job : before.jobs)
    if (std::find(overdue.begin(), overdue.end(), job.id) != overdue.end())
      dropped.insert(job.results.begin(), job.results.end());
  RETURN_IF_ERROR(blobs.each([&](const BlobFile& file) {
    const bool unused = !named.contains(file.digest) &&
                        (dropped.contains(file.digest) || file.age_seconds >= limits.keep_uploads_seconds);
    if (!unused) {
      swept.left_bytes += file.bytes;
      return;
    }
    blobs.remove(file.digest);
    ++swept.blobs;
    swept.bytes += file.bytes;
  }));
  return swept;
}

Retention::Retention(Coordinator& coordinator, const RetentionLimits& limits)
    : coordinator_(coordinator), limits_(limits), thread_([this] { run(); }) {}

Retention::~Retention() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Retention::run() {
  const std::chrono::duration<double> pause(std::clamp(
      std::min(limits_.keep_seconds, limits_.keep_uploads_seconds), kLeastPauseSeconds, kMostPauseSeconds));
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, pause, [&] { return stopping_; })) {
    lock.unlock();
    const absl::StatusOr<Swept> swept = sweep(coordinator_, limits_);
    lock.lock();
    if (!swept.ok()) {
      if (!stopping_) spdlog::warn("retention: {}", message_of(swept.status()));
    } else if (swept->jobs + swept->blobs > 0) {
      spdlog::info("retention: {} jobs and {} blobs removed, {} bytes; {} bytes left", swept->jobs,
                   swept->blobs, swept->bytes, swept->left_bytes);
    }
  }
}

}  // namespace penumbra

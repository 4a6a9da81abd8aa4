#include "server/coordinator.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "proto/status.h"

namespace penumbra {
namespace {

// Longest that a Sync waits: well below the silence after which its worker would be given up.
constexpr double kMostWaitSeconds = 5;
// The loop wakes at least this often, so that a deadline is never missed by more.
constexpr double kMostSleepSeconds = 1;
// Shorter commits do not matter for anybody's silence.
constexpr double kLongCommitSeconds = 0.05;
// Time between the store's rests: what it does then is no matter of a single commit.
constexpr double kRestSeconds = 1;

}  // namespace

Coordinator::Coordinator(std::unique_ptr<JobStore> store, BlobFolder blobs, SchedulerLimits limits,
                         Clock clock)
    : store_(std::move(store)), blobs_(std::move(blobs)), clock_(std::move(clock)), scheduler_(limits) {}

Coordinator::~Coordinator() {
  stop();
}

absl::Status Coordinator::start() {
  ASSIGN_OR_RETURN(const StoredState stored, store_->load());
  RETURN_IF_ERROR(scheduler_.restore(stored, clock_()));
  RETURN_IF_ERROR(commit());
  thread_ = std::thread([this] { run(); });
  return absl::OkStatus();
}

void Coordinator::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  posted_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Coordinator::post(Work work, std::function<void()> refuse) {
  {
    const std::lock_guard lock(mutex_);
    if (!stopping_ && !failed_) {
      inbox_.push_back({std::move(work), std::move(refuse)});
      posted_.notify_one();
      return;
    }
  }
  refuse();
}

void Coordinator::sync(uint64_t ticket, WorkerState state, std::vector<absl::StatusOr<ResultShape>> shapes,
                       SyncReply reply) {
  auto work = [this, ticket, state = std::move(state), shapes = std::move(shapes), reply](
                  Scheduler& scheduler, const Now& now) mutable -> Finish {
    if (const absl::Status status = scheduler.report(state, shapes, now); !status.ok())
      return [reply, status](const absl::Status&) { reply(status); };
    // Answered with the others, after all of this batch's reports are in.
    const double wait = std::min(state.wait_milliseconds * 1e-3, kMostWaitSeconds);
    waiting_.push_back({ticket, std::move(state), now.steady + wait, reply});
    return nullptr;
  };
  post(std::move(work), [reply] { reply(absl::UnavailableError("the server is stopping")); });
}

void Coordinator::cancel_sync(uint64_t ticket) {
  post(
      [this, ticket](Scheduler&, const Now&) -> Finish {
        const auto it = std::find_if(waiting_.begin(), waiting_.end(),
                                     [&](const Waiting& w) { return w.ticket == ticket; });
        if (it == waiting_.end()) return nullptr;
        SyncReply reply = std::move(it->reply);
        waiting_.erase(it);
        return [reply](const absl::Status&) { reply(absl::CancelledError("the worker has hung up")); };
      },
      [] {});
}

uint64_t Coordinator::wait_for_change(uint64_t revision, double seconds) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                    [&] { return published_revision_ != revision || stopping_; });
  return published_revision_;
}

absl::StatusOr<std::vector<PutLog>> Coordinator::worker_logs(const JobId& id, std::optional<uint64_t> tile,
                                                             size_t most_bytes) {
  using Logs = absl::StatusOr<std::vector<PutLog>>;
  absl::StatusOr<Logs> logs = call([&](Scheduler& scheduler, const Now&) -> Logs {
    const JobRecord* job = scheduler.find(id);
    if (job == nullptr) return make_status(absl::StatusCode::kNotFound, "no job {}", id);
    if (!tile) return store_->logs(id, 1, 0, most_bytes);
    // Ids go round and round the tiles, the pilot's as the run's (server/planner.h).
    RETURN_IF_ERROR(job->check_tile(*tile));
    return store_->logs(id, job->tiles().size(), *tile, most_bytes);
  });
  if (!logs.ok()) return logs.status();
  return *std::move(logs);
}

double Coordinator::next_deadline() const {
  const Now now = clock_();
  double next = now.steady + kMostSleepSeconds;
  for (const Waiting& waiting : waiting_) next = std::min(next, waiting.deadline);
  if (const auto expiry = scheduler_.next_expiry()) next = std::min(next, *expiry);
  return std::max(0.0, next - now.steady);
}

std::vector<Coordinator::Posted> Coordinator::next_batch() {
  const std::chrono::duration<double> sleep(next_deadline());
  std::unique_lock lock(mutex_);
  posted_.wait_for(lock, sleep, [&] { return !inbox_.empty() || stopping_; });
  return std::exchange(inbox_, {});
}

/// Answers every Sync that has something to hear or has waited long enough (or all of them).
void Coordinator::answer_waiting(const Now& now, std::vector<Finish>& finished, bool all) {
  const bool news = scheduler_.revision() != answered_revision_;
  for (auto it = waiting_.begin(); it != waiting_.end();) {
    const bool over = all || now.steady >= it->deadline;
    if (!news && !over && !std::exchange(it->fresh, false)) {
      ++it;
      continue;
    }
    SyncAnswer answer = scheduler_.answer(it->state, now);
    if (!answer.urgent && !over) {
      ++it;
      continue;
    }
    finished.push_back([reply = std::move(it->reply),
                        desired = std::move(answer.desired)](const absl::Status& durable) mutable {
      if (durable.ok())
        reply(std::move(desired));
      else
        reply(durable);
    });
    it = waiting_.erase(it);
  }
  answered_revision_ = scheduler_.revision();
}

/// Results' bytes first: a row must never name a blob that a power cut could take away.
absl::Status Coordinator::commit() {
  const std::vector<Change> changes = scheduler_.take_changes();
  if (changes.empty()) return absl::OkStatus();
  std::vector<Digest> results;
  for (const Change& change : changes)
    if (const auto* put = std::get_if<PutResult>(&change); put != nullptr && !put->result.empty())
      results.push_back(put->result);
  RETURN_IF_ERROR(blobs_.sync(results));
  return store_->apply(changes);
}

/// What the store does when all replies are out. Its troubles are its own, except that another server leads
/// now.
absl::Status Coordinator::rest() {
  const Now now = clock_();
  if (now.steady < next_rest_) return absl::OkStatus();
  next_rest_ = now.steady + kRestSeconds;
  const absl::Status rested = store_->rest();
  if (rested.ok() || absl::IsAborted(rested)) return rested;
  spdlog::warn("{}", message_of(rested));
  return absl::OkStatus();
}

/// The end, for whoever still waits; returns what they are told.
absl::Status Coordinator::give_up(const absl::Status& why) {
  spdlog::critical("the job store failed, the server ends: {}", message_of(why));
  failed_ = true;
  const absl::Status said = absl::UnavailableError("the server's store has failed");
  std::vector<Finish> waiting;
  answer_waiting(clock_(), waiting, true);
  for (const Finish& finish : waiting) finish(said);
  return said;
}

void Coordinator::run() {
  for (bool stopping = false; !stopping && !failed_;) {
    const std::vector<Posted> batch = next_batch();
    {
      const std::lock_guard lock(mutex_);
      stopping = stopping_;
    }
    const Now now = clock_();
    std::vector<Finish> finished;
    for (const Posted& posted : batch)
      if (Finish finish = posted.work(scheduler_, now)) finished.push_back(std::move(finish));
    scheduler_.expire(now);
    answer_waiting(now, finished, stopping);
    for (const Notice& notice : scheduler_.take_notices())
      log_about(notice.detail ? spdlog::level::debug : spdlog::level::info, notice.about, notice.text);
    const double began = clock_().steady;
    absl::Status durable = commit();
    // What workers have said meanwhile is not read yet. A slow disk must not cost them their leases.
    if (const double took = clock_().steady - began; took >= kLongCommitSeconds) scheduler_.excuse(took);
    if (!durable.ok()) durable = give_up(durable);
    for (const Finish& finish : finished) finish(durable);
    if (const absl::Status rested = failed_ ? absl::OkStatus() : rest(); !rested.ok())
      (void)give_up(rested);  // nobody waits for what it says
    const std::lock_guard lock(mutex_);
    published_revision_ = scheduler_.revision();
    changed_.notify_all();
  }
  std::vector<Posted> late;
  {
    const std::lock_guard lock(mutex_);
    late = std::exchange(inbox_, {});
  }
  for (const Posted& posted : late) posted.refuse();
}

}  // namespace penumbra

#include "worker/agent/agent.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <new>

#include "proto/convert.h"
#include "proto/rpc_status.h"
#include "proto/wire_text.h"
#include "worker/agent/identity.h"
#include "worker/agent/log_capture.h"

namespace penumbra {
namespace {

// A worker that could take more asks the server to hold its Sync this long; news of our own break it off.
constexpr uint32_t kWaitMilliseconds = 4000;
// A worker that has all it wants calls this often to hear of cancelled jobs.
constexpr double kBusySeconds = 0.5;
// A call that takes longer than its wait and this is lost.
constexpr int kCallSeconds = 10;
// What a scene can make us say travels in every Sync until it is acknowledged: one text, and all of a scene.
constexpr size_t kMostText = 4096, kMostTexts = size_t{256} << 10;
// Between attempts to reach a server that is away.
constexpr double kRetrySeconds = 0.2;

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Errors that trying again cannot cure.
bool is_refusal(const absl::Status& status) {
  return absl::IsFailedPrecondition(status) || absl::IsInvalidArgument(status) ||
         absl::IsUnauthenticated(status) || absl::IsPermissionDenied(status) || absl::IsUnimplemented(status);
}

TaskFailure failure_of(const absl::Status& status) {
  if (absl::IsInvalidArgument(status)) return TaskFailure::kBadInput;
  // The server's copy of the scene is gone or corrupt: no worker can do better.
  if (absl::IsDataLoss(status)) return TaskFailure::kLostInput;
  return TaskFailure::kError;
}

/// Passes, CPU seconds and what was refused, all mixes together.
std::string rendered_text(const Assignment& assignment, const TaskOutcome& outcome) {
  int64_t passes = 0;
  double seconds = 0;
  uint64_t refused = 0;
  for (const MixCost& cost : outcome.costs) {
    passes += cost.passes;
    seconds += cost.cpu_seconds;
    refused += cost.non_finite;
  }
  const PixelRect& tile = assignment.task.tile;
  return fmt::format("{} [{},{})x[{},{}): {} passes in {:.3f} CPU s{}",
                     assignment.task.kind == TaskKind::kPilot ? "pilot" : "rendered", tile.x0, tile.x1,
                     tile.y0, tile.y1, passes, seconds,
                     refused == 0 ? "" : fmt::format(", {} samples refused: not finite", refused));
}

}  // namespace

Agent::Agent(AgentOptions options, const std::shared_ptr<grpc::Channel>& channel, BlobFolder cache,
             const SceneLoader& loader)
    : options_(std::move(options)),
      stub_(v1::Worker::NewStub(channel)),
      cache_(std::move(cache)),
      blobs_(channel),
      scenes_(blobs_, cache_, loader, options_.threads, options_.scenes),
      board_(options_.threads),
      deadline_(std::numeric_limits<double>::infinity()) {}

Agent::~Agent() {
  (void)stop();
}

void Agent::start() {
  for (int i = 0; i < options_.threads; ++i) render_threads_.emplace_back([this] { render_loop(); });
  upload_thread_ = std::thread([this] { upload_loop(); });
  sync_thread_ = std::thread([this] { sync_loop(); });
}

void Agent::drain(std::optional<double> grace_seconds) {
  if (grace_seconds) deadline_ = std::min(deadline_.load(), steady_seconds() + *grace_seconds);
  draining_ = true;
  board_.drain();
}

absl::Status Agent::stop() {
  stopping_ = true;
  board_.close();
  {
    const std::lock_guard lock(upload_mutex_);
    upload_ready_.notify_all();
  }
  if (sync_thread_.joinable()) sync_thread_.join();
  if (upload_thread_.joinable()) upload_thread_.join();
  for (std::thread& thread : render_threads_)
    if (thread.joinable()) thread.join();
  return refusal_;
}

/// While draining: whether the end has come. Past the deadline what is left is handed back first.
bool Agent::drained() {
  if (!draining_) return false;
  if (steady_seconds() >= deadline_) {
    board_.abandon();
    // The server must hear of it, but not for longer than this.
    constexpr double kLastWordSeconds = 1;
    if (steady_seconds() >= deadline_ + kLastWordSeconds) return true;
  }
  return board_.empty();
}

void Agent::sync_loop() {
  while (!stopping_) {
    if (!sync_once()) break;
    if (drained()) break;
    if (board_.full()) board_.wait_for_news(kBusySeconds);
  }
  ended_ = true;
}

/// One exchange. False: the server refuses this worker.
bool Agent::sync_once() {
  WorkerState state;
  state.version = PENUMBRA_VERSION;
  state.worker = options_.worker;
  state.name = options_.name;
  state.process_cpu_seconds = process_cpu_seconds();
  board_.describe(state);
  const bool reports = !state.completed.empty() || !state.failed.empty() || !state.loaded.empty();
  const bool full = state.held.size() >= state.wanted;
  // A draining worker looks at its clock between calls.
  state.wait_milliseconds = reports ? 0 : draining_ ? 200 : full ? 0 : kWaitMilliseconds;

  const v1::SyncRequest request = to_proto(state);
  v1::SyncResponse response;
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(kCallSeconds) +
                       std::chrono::milliseconds(state.wait_milliseconds));
  bool done = false;
  grpc::Status rpc;
  stub_->async()->Sync(&context, &request, &response, [&](grpc::Status result) {
    rpc = std::move(result);
    board_.set(done);
  });
  // News break off a call that is only waiting; one that reports is over as soon as the server has kept what
  // it says.
  constexpr double kLookSeconds = 0.5;
  const bool waits = state.wait_milliseconds > 0;
  for (bool over = false; !over;) {
    const auto woken = waits                                 ? board_.wait_for_news_or(done, kLookSeconds)
                       : board_.wait_for(done, kLookSeconds) ? TaskBoard::Woken::kDone
                                                             : TaskBoard::Woken::kTime;
    over = woken == TaskBoard::Woken::kDone;
    if (over || (!stopping_ && woken != TaskBoard::Woken::kNews)) continue;
    context.TryCancel();
    while (!over) over = board_.wait_for(done, kLookSeconds);
  }
  return take_answer(from_grpc(rpc), response, state);
}

bool Agent::take_answer(const absl::Status& status, const v1::SyncResponse& response,
                        const WorkerState& told) {
  if (absl::IsCancelled(status)) return true;  // broken off by us
  const absl::StatusOr<DesiredState> desired =
      status.ok() ? from_proto(response) : absl::StatusOr<DesiredState>(status);
  if (desired.ok()) {
    if (!std::exchange(reachable_, true)) spdlog::info("the server is back");
    const auto missing = board_.apply(*desired, told);
    {
      const std::lock_guard lock(upload_mutex_);
      for (const auto& finished : missing) uploads_.push_back({nullptr, finished});
      upload_ready_.notify_one();
    }
    return true;
  }
  if (is_refusal(desired.status())) {
    refusal_ = desired.status();
    return false;
  }
  if (std::exchange(reachable_, false))
    spdlog::warn("the server cannot be reached, trying again: {}", message_of(desired.status()));
  pause(kRetrySeconds);
  return true;
}

void Agent::pause(double seconds) {
  const double end = steady_seconds() + seconds;
  while (!stopping_ && steady_seconds() < end) std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

void Agent::render_loop() {
  while (const std::shared_ptr<Assignment> assignment = board_.take()) {
    const LogCapture capture;
    absl::StatusOr<TaskOutcome> outcome = outcome_of(*assignment);
    if (assignment->cancel || (outcome.ok() && outcome->cancelled)) {
      board_.drop(*assignment);
    } else if (!outcome.ok()) {
      log_about(spdlog::level::warn, about(assignment->lease), message_of(outcome.status()));
      board_.fail(*assignment, failure_of(outcome.status()),
                  wire_text(message_of(outcome.status()), kMostText),
                  wire_text(capture.text(), LogCapture::kMostBytes));
    } else {
      log_about(spdlog::level::debug, about(assignment->lease), rendered_text(*assignment, *outcome));
      hand_in(assignment, *std::move(outcome), wire_text(capture.text(), LogCapture::kMostBytes));
    }
  }
}

About Agent::about(const LeaseId& lease) const {
  return {lease.job, lease.task, std::nullopt, options_.worker.host + "/" + options_.name};
}

absl::StatusOr<TaskOutcome> Agent::outcome_of(const Assignment& assignment) {
  const double asked = steady_seconds();
  ASSIGN_OR_RETURN(const CachedScene cached,
                   scenes_.get(*assignment.job, [&] { return assignment.cancel || stopping_; }));
  log_about(spdlog::level::debug, about(assignment.lease),
            fmt::format("scene there after {:.3f} s; parsed in {:.3f} s, built in {:.3f} s, {} warnings",
                        steady_seconds() - asked, cached.report.parse_seconds, cached.report.build_seconds,
                        cached.report.warnings.size()));
  LoadedScene loaded{assignment.lease.job, cached.report, {}};
  loaded.report.warnings = wire_texts(cached.report.warnings, kMostText, kMostTexts);
  for (size_t m = 0; m < assignment.job->mixes.size(); ++m)
    for (const std::string& text : cached.scene->substitutions(assignment.job->mixes[m]))
      loaded.substitutions.push_back({static_cast<int>(m), wire_text(text, kMostText)});
  board_.loaded(loaded);
  try {
    return cached.scene->render(*assignment.job, assignment.task, assignment.cancel);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("out of memory while a tile was rendered (see --max-memory)");
  } catch (const std::exception& error) {
    return make_status(absl::StatusCode::kInternal, "while a tile was rendered: {}", error.what());
  }
}

void Agent::hand_in(const std::shared_ptr<Assignment>& assignment, TaskOutcome outcome, std::string log) {
  auto finished = std::make_shared<Finished>();
  finished->report.lease = assignment->lease;
  finished->report.costs = std::move(outcome.costs);
  finished->report.log = std::move(log);
  if (assignment->task.kind == TaskKind::kPilot) {
    board_.complete(*assignment, std::move(finished));
    return;
  }
  finished->bytes = serialize(outcome.pixels);
  if (finished->bytes.size() <= kMostBytesAlong) {
    finished->report.result = sha256(finished->bytes);
    finished->along = true;
    board_.complete(*assignment, std::move(finished));
    return;
  }
  const std::lock_guard lock(upload_mutex_);
  uploads_.push_back({assignment, std::move(finished)});
  upload_ready_.notify_one();
}

void Agent::upload_loop() {
  while (!stopping_) {
    ToUpload next;
    {
      std::unique_lock lock(upload_mutex_);
      upload_ready_.wait(lock, [&] { return stopping_ || !uploads_.empty(); });
      if (stopping_) return;
      next = std::move(uploads_.front());
      uploads_.pop_front();
    }
    upload(next);
  }
}

/// Tries for as long as the server is away and the lease is ours.
void Agent::upload(const ToUpload& item) {
  Finished& finished = *item.finished;
  if (finished.report.result.empty()) finished.report.result = sha256(finished.bytes);
  for (bool told_full = false;;) {
    const absl::Status status = blobs_.upload(finished.report.result, finished.bytes);
    // A server whose disk is full keeps what it has and takes more when there is room again.
    const bool full = absl::IsResourceExhausted(status);
    if (full && !std::exchange(told_full, true))
      log_about(spdlog::level::warn, about(finished.report.lease), message_of(status) + "; trying again");
    const bool again =
        full || absl::IsUnavailable(status) || absl::IsAborted(status) || absl::IsCancelled(status);
    if (stopping_) return;
    const LeaseId& lease = finished.report.lease;
    if (!again || !(item.assignment ? !item.assignment->cancel.load() : board_.wants(lease)))
      return settle(item, status);
    pause(kRetrySeconds);
  }
}

void Agent::settle(const ToUpload& item, const absl::Status& status) {
  Finished& finished = *item.finished;
  if (!item.assignment)
    board_.uploaded(finished);
  else if (item.assignment->cancel)
    board_.drop(*item.assignment);
  else if (status.ok())
    board_.complete(*item.assignment, item.finished);
  else
    board_.fail(*item.assignment, TaskFailure::kError, "uploading the result: " + message_of(status),
                finished.report.log);
}

}  // namespace penumbra

#include "tests/system/chaos/drill.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

#include "proto/convert.h"
#include "tests/system/chaos/audit.h"

namespace penumbra {
namespace {

constexpr int kWorkers = 3;
constexpr double kSilence = 2;
constexpr size_t kUnfinishedJobs = 3;

void sleep_seconds(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

void flip_a_byte(const std::string& path, uint64_t place) {
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  if (!file || error || size == 0) return;
  const auto at = static_cast<std::streamoff>(place % size);
  file.seekg(at);
  const char byte = static_cast<char>(file.get() ^ 0x10);
  file.seekp(at);
  file.put(byte);
}

}  // namespace

Drill::Drill(uint64_t seed) : cluster_("chaos"), random_(seed) {
  const std::string clock = cluster_.path("clock");
  std::ofstream(clock) << 0;
  cluster_.server_prefix = cluster_.worker_prefix = {
      "env", std::string("LD_PRELOAD=") + PENUMBRA_JUMPING_CLOCK, "PENUMBRA_CLOCK_FILE=" + clock};
  cluster_.server_flags = {"--silence", fmt::format("{}s", kSilence), "--task-limit", "20s"};
  cluster_.start_server();
  bundle_ = cluster_.upload_scene("3");
  workers_.resize(kWorkers);
  for (int slot = 0; slot < kWorkers; ++slot) start_worker(slot);
}

int Drill::faults() const {
  int sum = 0;
  for (const auto& [kind, count] : injected_) sum += count;
  return sum;
}

std::string Drill::summary() const {
  std::string text = fmt::format("{} faults:", faults());
  for (const auto& [kind, count] : injected_) text += fmt::format(" {} {},", count, kind);
  const auto cancelled =
      std::count_if(jobs_.begin(), jobs_.end(), [](const Job& job) { return job.cancelled; });
  return text + fmt::format(" {} jobs, {} of them cancelled", jobs_.size(), cancelled);
}

void Drill::run(double seconds) {
  for (const double end = steady_seconds() + seconds;
       steady_seconds() < end && !testing::Test::HasFailure();) {
    resume_absent(false);
    tend_jobs();
    inject();
    sleep_seconds(draw_seconds(0.6));
    check_leases();
  }
}

void Drill::inject() {
  struct Kind {
    const char* name;
    void (Drill::*inject)();
  };
  static constexpr Kind kKinds[] = {
      {"server killed", &Drill::restart_server},   {"worker stopped", &Drill::stop_worker},
      {"server stopped", &Drill::stop_server},     {"result damaged", &Drill::damage_result},
      {"cache damaged", &Drill::damage_cache},     {"clock jumped", &Drill::jump_clock},
      {"lease kept", &Drill::rogue_vanishes},      {"garbage sent", &Drill::rogue_sends_garbage},
      {"message repeated", &Drill::rogue_repeats}, {"result late", &Drill::rogue_comes_late},
      {"worker drained", &Drill::drain_worker},    {"job cancelled", &Drill::cancel_job},
      {"all killed", &Drill::kill_everything},     {"client hung up", &Drill::hang_up},
  };
  // Killed workers are the most common fault of farms: as often as three others together.
  const uint64_t kind = draw(std::size(kKinds) + 3);
  if (kind >= std::size(kKinds)) {
    ++injected_["worker killed"];
    kill_worker(static_cast<int>(draw(kWorkers)));
    return;
  }
  ++injected_[kKinds[kind].name];
  (this->*kKinds[kind].inject)();
}

void Drill::restart_server() {
  cluster_.server().kill_hard();
  sleep_seconds(draw_seconds(0.5));
  cluster_.start_server();
  renew_kept("");
}

void Drill::start_worker(int slot) {
  std::vector<std::string> command = cluster_.worker_prefix;
  for (const std::string& word : {std::string(PENUMBRA_FAKE_WORKER), std::string("--server"),
                                  cluster_.address(), std::string("--threads"), std::string("2"),
                                  std::string("--cache"), cluster_.path(fmt::format("cache-{}", slot))})
    command.push_back(word);
  workers_[slot] = std::make_unique<Process>(command, cluster_.path("worker.log"));
}

void Drill::kill_worker(int slot) {
  std::erase_if(absent_, [&](const Absent& absent) { return absent.worker == slot; });
  workers_[slot]->kill_hard();
  start_worker(slot);
}

/// As a network partition looks from the server: sometimes for longer than the silence that it bears.
void Drill::stop_worker() {
  const int slot = static_cast<int>(draw(kWorkers));
  workers_[slot]->signal(SIGSTOP);
  absent_.push_back({slot, steady_seconds() + draw_seconds(2 * kSilence)});
}

void Drill::resume_absent(bool all) {
  std::erase_if(absent_, [&](const Absent& absent) {
    if (!all && steady_seconds() < absent.until) return false;
    workers_[absent.worker]->signal(SIGCONT);
    return true;
  });
}

void Drill::stop_server() {
  cluster_.server().signal(SIGSTOP);
  sleep_seconds(draw_seconds(1));
  cluster_.server().signal(SIGCONT);
}

void Drill::damage_result() {
  const std::vector<std::string> files = cluster_.result_files();
  if (files.empty()) return;
  const std::string& file = files[draw(files.size())];
  std::error_code error;
  if (draw(2) == 0)
    flip_a_byte(file, random_());
  else
    std::filesystem::remove(file, error);
}

void Drill::damage_cache() {
  const int slot = static_cast<int>(draw(kWorkers));
  const Digest scene = sha256("3");
  flip_a_byte(cluster_.path(fmt::format("cache-{}/{}/{}", slot, scene.substr(0, 2), scene)), 0);
  kill_worker(slot);  // one that has loaded the scene would not look again
}

void Drill::jump_clock() {
  std::ofstream(cluster_.path("clock")) << static_cast<int64_t>(draw(20 * 86400)) - 10 * 86400;
}

/// A word of the rogue's, or a restart of the server, gives its leases another silence to live.
void Drill::renew_kept(const std::string& rogue) {
  for (Kept& kept : kept_)
    if (rogue.empty() || kept.rogue == rogue) kept.since = steady_seconds();
}

void Drill::rogue_vanishes() {
  HandWorker rogue(cluster_, fmt::format("rogue-{}", rogues_++));
  for (const DesiredLease& lease : rogue.take(2))
    kept_.push_back({lease, rogue.state.name, steady_seconds()});
  said_.push_back(rogue.state);
}

void Drill::rogue_sends_garbage() {
  HandWorker garbler(cluster_, "garbler");
  for (const DesiredLease& lease : garbler.take(1)) {
    std::string bytes = flat_result(*lease.task, 1);
    if (draw(2) == 0)
      bytes.resize(bytes.size() / 2);
    else
      bytes[4] ^= 1;  // the version
    garbler.state.held.clear();
    garbler.state.wanted = 0;
    garbler.state.completed = {garbler.result_of(lease, bytes)};
    EXPECT_TRUE(garbler.say(garbler.state).ok());
    said_.push_back(garbler.state);
  }
}

void Drill::rogue_repeats() {
  if (said_.empty()) return rogue_vanishes();
  WorkerState old = said_[draw(said_.size())];
  old.wanted = 0;
  EXPECT_TRUE(HandWorker(cluster_, old.name).say(old).ok());
  renew_kept(old.name);
}

/// The result is of the right shape and wrong in every pixel: it must not be taken.
void Drill::rogue_comes_late() {
  const auto late = std::find_if(kept_.begin(), kept_.end(), [](const Kept& kept) {
    return steady_seconds() - kept.since > 3 * kSilence;
  });
  if (late == kept_.end()) return rogue_vanishes();
  HandWorker rogue(cluster_, late->rogue);
  rogue.state.completed = {rogue.result_of(late->lease, flat_result(*late->lease.task, 9))};
  kept_.erase(late);
  const auto answer = rogue.say(rogue.state);
  ASSERT_TRUE(answer.ok()) << answer.status();
  EXPECT_EQ(answer->acknowledged.size(), 1u);
  said_.push_back(rogue.state);
}

void Drill::drain_worker() {
  const int slot = static_cast<int>(draw(kWorkers));
  resume_absent(true);
  workers_[slot]->signal(SIGTERM);
  EXPECT_EQ(workers_[slot]->wait(30), 0);
  start_worker(slot);
}

void Drill::cancel_job() {
  for (Job& job : jobs_) {
    if (job.cancelled || job.checked) continue;
    v1::JobRequest request;
    request.set_job(job.id);
    grpc::ClientContext context;
    v1::JobStatus response;
    EXPECT_TRUE(cluster_.render().Cancel(&context, request, &response).ok());
    job.cancelled = response.state() == v1::JOB_STATE_CANCELLED;
    return;
  }
}

void Drill::kill_everything() {
  absent_.clear();
  for (const auto& worker : workers_) worker->kill_hard();
  cluster_.server().kill_hard();
  cluster_.start_server();
  renew_kept("");
  for (int slot = 0; slot < kWorkers; ++slot) start_worker(slot);
}

void Drill::hang_up() {
  if (jobs_.empty()) return;
  v1::FetchFramesRequest request;
  request.set_job(jobs_[draw(jobs_.size())].id);
  request.set_checkpoints(true);
  grpc::ClientContext context;
  const auto reader = cluster_.render().FetchFrames(&context, request);
  v1::FetchFramesResponse message;
  reader->Read(&message);
  context.TryCancel();
  reader->Finish();
}

/// New jobs while there are few; those that are done are looked at.
void Drill::tend_jobs() {
  size_t unfinished = 0;
  for (Job& job : jobs_) {
    if (job.cancelled || job.checked) continue;
    if (cluster_.status(job.id).state == JobState::kDone)
      job.checked = check_picture(job, 0);
    else
      ++unfinished;
  }
  while (unfinished++ < kUnfinishedJobs) jobs_.push_back({cluster_.submit(cluster_.spec(bundle_))});
}

/// True if the picture is there and right. A result that the disk has lost makes it come later.
bool Drill::check_picture(Job& job, double seconds) {
  for (const double end = steady_seconds() + seconds;; sleep_seconds(0.2)) {
    Picture picture;
    RunSummary summary;
    const grpc::Status status = cluster_.try_fetch(job.id, picture, summary);
    if (status.ok() && summary.status.state == JobState::kDone) {
      EXPECT_TRUE(picture == calm()) << "job " << job.id << ": pixels differ";
      return true;
    }
    EXPECT_TRUE(status.ok() || status.error_code() == grpc::StatusCode::UNAVAILABLE)
        << status.error_message();
    if (steady_seconds() >= end) return false;
  }
}

/// No worker that has been silent for longer than allowed (and than the server itself was stopped) is still
/// counted as one that holds tasks.
void Drill::check_leases() {
  constexpr double kMostStopped = 1, kMostSleep = 1;
  for (const Job& job : jobs_) {
    if (job.cancelled || job.checked) continue;
    v1::JobRequest request;
    request.set_job(job.id);
    grpc::ClientContext context;
    v1::ExplainResponse response;
    ASSERT_TRUE(cluster_.render().Explain(&context, request, &response).ok());
    for (const std::string& reason : response.reasons()) {
      const size_t called = reason.find("it called ");
      if (called == std::string::npos) continue;
      EXPECT_LE(std::stod(reason.substr(called + 10)), kSilence + kMostSleep + kMostStopped + 0.5) << reason;
    }
    return;
  }
}

void Drill::settle() {
  if (testing::Test::HasFailure()) return;  // nothing is sure to come to rest
  resume_absent(true);
  sleep_seconds(kSilence + 1);             // what the rogues still hold falls back
  for (int round = 0; round < 2; ++round)  // damage may have come to a picture that was looked at before
    for (Job& job : jobs_) {
      if (job.cancelled) continue;
      EXPECT_EQ(cluster_.wait_end(job.id, 120).state, JobState::kDone) << cluster_.status(job.id).message;
      EXPECT_TRUE(check_picture(job, 60)) << "job " << job.id << " has no picture";
    }
  std::vector<JobStatus> statuses;
  for (const Job& job : jobs_) statuses.push_back(cluster_.status(job.id));
  for (const auto& worker : workers_) worker->kill_hard();
  cluster_.server().kill_hard();
  for (const std::string& fault : audit(cluster_.path("store"), statuses)) ADD_FAILURE() << fault;
}

}  // namespace penumbra

#include "tests/system/cluster/cluster.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "proto/channel.h"
#include "proto/convert.h"
#include "proto/rpc_status.h"

namespace penumbra {
namespace {

void nap() {
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

std::string read_text(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

double patience() {
  static const double factor = [] {
    const char* text = std::getenv("PENUMBRA_PATIENCE");
    return text == nullptr ? 1 : std::strtod(text, nullptr);
  }();
  return factor;
}

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Process::Process(const std::vector<std::string>& command, const std::string& stderr_path) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_ = fork();
  if (pid_ != 0) return;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int log = open(stderr_path.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  dup2(log, STDERR_FILENO);
  dup2(log, STDOUT_FILENO);
  execvp(arguments[0], arguments.data());
  _exit(127);
}

Process::~Process() {
  kill_hard();
}

void Process::signal(int number) const {
  if (pid_ > 0) kill(pid_, number);
}

void Process::kill_hard() {
  if (pid_ <= 0) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

std::optional<int> Process::wait(double seconds) {
  for (const double end = steady_seconds() + patience() * seconds; steady_seconds() < end; nap()) {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) != pid_) continue;
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  return std::nullopt;
}

Cluster::Cluster(const std::string& name)
    : root_(std::filesystem::path(testing::TempDir()) /
            ("penumbra-" + name + "-" + std::to_string(getpid()))) {
  std::filesystem::remove_all(root_);
  std::filesystem::create_directories(root_);
}

/// A program that is killed has no exit code to say what a sanitiser has found in it: its log does.
void Cluster::expect_sound() const {
  for (const auto& entry : std::filesystem::directory_iterator(root_)) {
    if (entry.path().extension() != ".log") continue;
    const std::string log = read_text(entry.path());
    for (const std::string_view found : {"Sanitizer: ", "runtime error: "})
      EXPECT_EQ(log.find(found), std::string::npos) << entry.path() << ":\n" << log;
  }
}

Cluster::~Cluster() {
  workers_.clear();
  server_.reset();
  expect_sound();
  if (testing::Test::HasFailure())
    std::fprintf(stderr, "%s\n%s\n", server_log().c_str(), read_text(path("worker.log")).c_str());
  std::error_code error;
  std::filesystem::remove_all(root_, error);
}

std::string Cluster::server_log() const {
  return read_text(path("server.log"));
}

void Cluster::start_server() {
  const std::string file = path("address");
  std::filesystem::remove(file);
  if (address_.empty()) address_ = listen_host + ":0";
  std::vector<std::string> command = server_prefix;
  for (const std::string& word : {std::string(PENUMBRA_SERVER), std::string("--listen"), address_,
                                  std::string("--store"), path("store"), std::string("--address-file"), file})
    command.push_back(word);
  command.insert(command.end(), server_flags.begin(), server_flags.end());
  server_ = std::make_unique<Process>(command, path("server.log"));
  for (const double end = steady_seconds() + patience() * 30; !std::filesystem::exists(file); nap())
    ASSERT_LT(steady_seconds(), end) << server_log();
  std::stringstream(read_text(file)) >> address_;
  const auto channel = *open_channel(address_, credentials);
  render_ = v1::Render::NewStub(channel);
  // The address is written before the first poll, and a channel to a killed predecessor at this address may
  // not have noticed yet: only an answered call says that calls are answered.
  for (const double end = steady_seconds() + patience() * 30;; nap()) {
    grpc::ClientContext context;
    context.set_wait_for_ready(true);
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
    v1::ListJobsResponse jobs;
    const grpc::Status answered = render_->ListJobs(&context, {}, &jobs);
    if (answered.ok()) break;
    ASSERT_LT(steady_seconds(), end) << answered.error_message() << "\n" << server_log();
  }
  blobs_ = v1::Blobs::NewStub(channel);
  worker_stub_ = v1::Worker::NewStub(channel);
}

Process& Cluster::start_worker(int threads, const std::string& cache) {
  std::vector<std::string> command = worker_prefix;
  for (const std::string& word :
       {std::string(PENUMBRA_FAKE_WORKER), std::string("--server"), address_, std::string("--threads"),
        std::to_string(threads), std::string("--cache"), path(cache)})
    command.push_back(word);
  command.insert(command.end(), worker_flags.begin(), worker_flags.end());
  workers_.push_back(std::make_unique<Process>(command, path("worker.log")));
  return *workers_.back();
}

grpc::Status Cluster::upload(const Digest& digest, const std::string& bytes) {
  grpc::ClientContext context;
  v1::UploadResponse response;
  const auto writer = blobs_->Upload(&context, &response);
  v1::UploadChunk chunk;
  chunk.set_digest(digest);
  chunk.set_size(bytes.size());
  chunk.set_data(bytes);
  writer->Write(chunk);
  writer->WritesDone();
  return writer->Finish();
}

Digest Cluster::upload_scene(const std::string& text) {
  BundleIndex index;
  index.main = "scene.pbrt";
  index.entries = {{"scene.pbrt", "scene.pbrt", sha256(text), text.size()}};
  const std::string json = serialize(index);
  EXPECT_TRUE(upload(sha256(text), text).ok());
  EXPECT_TRUE(upload(sha256(json), json).ok());
  return sha256(json);
}

JobSpec Cluster::spec(const Digest& bundle) const {
  JobSpec spec;
  spec.scene = "/scene.pbrt";
  spec.bundle = bundle;
  spec.mixes = {*parse_mix("sa:1"), *parse_mix("bsdf:2")};
  spec.budget = SppBudget{32};
  spec.width = 96;
  spec.height = 64;
  spec.crop = {0, 0, 96, 64};
  spec.tile = 32;
  spec.seed = 5;
  return spec;
}

grpc::Status Cluster::try_submit(const JobSpec& spec, const JobTerms& terms, JobId& job) {
  v1::SubmitRequest request;
  *request.mutable_spec() = to_proto(spec);
  *request.mutable_terms() = to_proto(terms);
  static int counter = 0;
  request.set_request_id("r" + std::to_string(counter++));
  grpc::ClientContext context;
  v1::SubmitResponse response;
  const grpc::Status status = render_->Submit(&context, request, &response);
  job = response.job();
  return status;
}

JobId Cluster::submit(const JobSpec& spec, const JobTerms& terms) {
  JobId job;
  const grpc::Status status = try_submit(spec, terms, job);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return job;
}

JobStatus Cluster::status(const JobId& job) {
  v1::JobRequest request;
  request.set_job(job);
  grpc::ClientContext context;
  context.set_wait_for_ready(true);  // the server may be restarting
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(30));
  v1::JobStatus response;
  const grpc::Status rpc = render_->GetJob(&context, request, &response);
  EXPECT_TRUE(rpc.ok()) << rpc.error_message();
  const auto converted = from_proto(response);
  EXPECT_TRUE(converted.ok()) << converted.status();
  return converted.value_or(JobStatus{});
}

JobStatus Cluster::wait_until(const JobId& job, double seconds,
                              const std::function<bool(const JobStatus&)>& wanted) {
  const double end = steady_seconds() + patience() * seconds;
  for (;; nap()) {
    JobStatus now = status(job);
    if (wanted(now)) return now;
    if (steady_seconds() < end && !testing::Test::HasFailure()) continue;
    ADD_FAILURE() << "job is " << name_of(now.state) << " " << now.tasks_done << "/" << now.tasks_total << " "
                  << now.message;
    return now;
  }
}

JobStatus Cluster::wait_end(const JobId& job, double seconds) {
  return wait_until(job, seconds, [](const JobStatus& status) { return is_final(status.state); });
}

grpc::Status Cluster::try_fetch(const JobId& job, Picture& picture, RunSummary& summary) {
  v1::FetchFramesRequest request;
  request.set_job(job);
  grpc::ClientContext context;
  const auto reader = render_->FetchFrames(&context, request);
  v1::FetchFramesResponse message;
  bool ended = false;
  while (reader->Read(&message)) {
    if (message.has_summary()) {
      auto converted = from_proto(message.summary());
      EXPECT_TRUE(converted.ok()) << converted.status();
      if (converted.ok()) summary = *std::move(converted);
      for (auto* layer : {&picture.mean, &picture.variance, &picture.samples})
        layer->assign(summary.mixes.size(), {});
    } else if (message.has_frame()) {
      const v1::FrameChunk& chunk = message.frame();
      auto& mean = picture.mean.at(chunk.mix());
      auto& variance = picture.variance.at(chunk.mix());
      auto& samples = picture.samples.at(chunk.mix());
      mean.insert(mean.end(), chunk.mean().begin(), chunk.mean().end());
      variance.insert(variance.end(), chunk.variance().begin(), chunk.variance().end());
      samples.insert(samples.end(), chunk.samples().begin(), chunk.samples().end());
    } else {
      ended = message.has_end();
    }
  }
  const grpc::Status status = reader->Finish();
  EXPECT_EQ(status.ok(), ended);
  return status;
}

RunSummary Cluster::fetch(const JobId& job, Picture& picture) {
  RunSummary summary;
  const grpc::Status status = try_fetch(job, picture, summary);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return summary;
}

std::string Cluster::blob_path(const Digest& digest) const {
  return path("store/blobs/" + digest.substr(0, 2) + "/" + digest);
}

std::vector<std::string> Cluster::result_files() const {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path("store/blobs")))
    if (entry.is_regular_file() && read_text(entry.path()).substr(0, 4) == "PNTR")
      out.push_back(entry.path());
  return out;
}

}  // namespace penumbra

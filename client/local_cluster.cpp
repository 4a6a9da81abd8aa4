#include "client/local_cluster.h"

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto kServerStart = 20s;  // a loaded machine, a cold disk
constexpr auto kPatience = 5s;      // between SIGTERM and SIGKILL
constexpr int kLogLines = 20;

absl::StatusOr<std::string> make_folder() {
  std::string pattern = fs::temp_directory_path() / "penumbra-XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr)
    return make_status(absl::StatusCode::kFailedPrecondition, "{}: cannot create: {}", pattern,
                       std::strerror(errno));
  return pattern;
}

absl::Status ended(const char* what, ChildProcess& process) {
  return make_status(absl::StatusCode::kAborted, "the local {} ended with {}:\n{}", what, process.ending(),
                     tail_of(process.log(), kLogLines));
}

}  // namespace

absl::StatusOr<LocalCluster> LocalCluster::start(const ClusterSize& size, const std::string& programs) {
  LocalCluster cluster;
  cluster.size_ = size;
  cluster.programs_ = programs;
  ASSIGN_OR_RETURN(cluster.folder_, make_folder());
  RETURN_IF_ERROR(cluster.start_server());
  for (int i = 0; i < size.workers; ++i) RETURN_IF_ERROR(cluster.start_worker(static_cast<size_t>(i)));
  return cluster;
}

LocalCluster::~LocalCluster() {
  stop();
}

absl::StatusOr<std::string> LocalCluster::program(const std::string& name) const {
  if (programs_.empty()) return program_beside_this(name);
  const fs::path base = programs_;
  for (const fs::path& path : {base / "bin" / name, base / name})
    if (access(path.c_str(), X_OK) == 0) return path.string();
  return invalid_input("{}: no build is there: it has no bin/{}", programs_, name);
}

absl::Status LocalCluster::start_server() {
  ASSIGN_OR_RETURN(const std::string program, this->program("penumbra-server"));
  const fs::path folder = folder_, announced = folder / "address";
  std::vector<std::string> arguments = {"--listen", "127.0.0.1:0", "--store", folder / "store", "--address-file",
                                        announced};
  if (programs_.empty()) arguments.push_back("--ephemeral");  // another build may be too old to know it
  ASSIGN_OR_RETURN(ChildProcess server, ChildProcess::start(program, arguments, folder / "server.log"));
  server_.push_back(std::move(server));
  // The file appears whole (renamed) once the server listens.
  const auto end = std::chrono::steady_clock::now() + kServerStart;
  while (address_.empty()) {
    if (!server_[0].running()) return ended("server", server_[0]);
    if (std::chrono::steady_clock::now() > end)
      return make_status(absl::StatusCode::kAborted, "the local server does not listen after {} s:\n{}",
                         kServerStart.count(), tail_of(server_[0].log(), kLogLines));
    std::ifstream(announced) >> address_;
    if (address_.empty()) std::this_thread::sleep_for(2ms);
  }
  return absl::OkStatus();
}

absl::Status LocalCluster::start_worker(size_t index) {
  ASSIGN_OR_RETURN(const std::string program, this->program("penumbra-worker"));
  const fs::path folder = folder_;
  // The server's own blobs are the workers' cache: nothing is copied from one folder of this machine to another.
  ASSIGN_OR_RETURN(ChildProcess worker,
                   ChildProcess::start(program,
                                       {"--server", address_, "--threads", fmt::format("{}", size_.threads),
                                        "--cache", folder / "store" / "blobs"},
                                       folder / fmt::format("worker-{}.log", index + 1)));
  if (index == workers_.size()) {
    workers_.push_back(std::move(worker));
  } else {
    workers_[index] = std::move(worker);
  }
  return absl::OkStatus();
}

absl::Status LocalCluster::tend() {
  if (!server_[0].running()) return ended("server", server_[0]);
  const int most_restarts = 3 * size_.workers;
  for (size_t i = 0; i < workers_.size(); ++i) {
    if (workers_[i].running()) continue;
    if (restarts_++ >= most_restarts) return ended("worker", workers_[i]);
    spdlog::warn("local worker {} ended with {}; started again", i + 1, workers_[i].ending());
    RETURN_IF_ERROR(start_worker(i));
  }
  return absl::OkStatus();
}

void LocalCluster::stop() {
  // Workers first: then the server sees them leave and has nothing to wait for.
  for (ChildProcess& worker : workers_) worker.terminate();
  for (ChildProcess& worker : workers_)
    if (!worker.wait_for(kPatience)) worker.kill();
  for (ChildProcess& server : server_) server.terminate();
  for (ChildProcess& server : server_)
    if (!server.wait_for(kPatience)) server.kill();
  workers_.clear();
  server_.clear();
  if (folder_.empty()) return;
  std::error_code ignored;  // nothing of value is left there
  fs::remove_all(folder_, ignored);
  folder_.clear();
}

}  // namespace penumbra

#pragma once
// Real processes and sockets for the system tests: a server, workers, and a small client.
#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proto/blobs.grpc.pb.h"
#include "proto/channel.h"
#include "proto/render.grpc.pb.h"
#include "proto/run.h"
#include "proto/worker.grpc.pb.h"
#include "scenes/bundle.h"

namespace penumbra {

/// A child process, killed when it goes out of scope. stderr goes to a file.
class Process {
 public:
  Process(const std::vector<std::string>& command, const std::string& stderr_path);
  ~Process();
  Process(const Process&) = delete;
  void signal(int number) const;
  void kill_hard();
  /// Exit code, or none if it is still running after `seconds`; 128 + signal if one ended it.
  std::optional<int> wait(double seconds);
  pid_t pid() const { return pid_; }

 private:
  pid_t pid_;
};

struct Picture {
  std::vector<std::vector<float>> mean, variance, samples;  ///< per mix
  bool operator==(const Picture&) const = default;
};

class Cluster {
 public:
  explicit Cluster(const std::string& name);
  ~Cluster();

  // Of servers and workers that are started from now on: what their command begins with (env, unshare), and
  // further flags.
  std::vector<std::string> server_prefix, server_flags, worker_prefix, worker_flags;
  Credentials credentials;  ///< of the calls made by this object
  std::string listen_host = "127.0.0.1";

  /// Starts a server on a free port (or again on the same) and connects.
  void start_server();
  Process& server() { return *server_; }
  Process& start_worker(int threads = 1, const std::string& cache = "cache");
  Process& worker(size_t i) { return *workers_.at(i); }
  std::string server_log() const;
  const std::string& address() const { return address_; }
  std::string path(const std::string& name) const { return (root_ / name).string(); }

  v1::Render::Stub& render() { return *render_; }
  v1::Blobs::Stub& blobs() { return *blobs_; }
  v1::Worker::Stub& workers_stub() { return *worker_stub_; }

  grpc::Status upload(const Digest& digest, const std::string& bytes);
  /// Uploads a bundle of one file with this text; its digest.
  Digest upload_scene(const std::string& text);
  JobSpec spec(const Digest& bundle) const;
  JobId submit(const JobSpec& spec, const JobTerms& terms = {});
  grpc::Status try_submit(const JobSpec& spec, const JobTerms& terms, JobId& job);
  JobStatus status(const JobId& job);
  /// Until `wanted` says so; fails the test after `seconds`.
  JobStatus wait_until(const JobId& job, double seconds, const std::function<bool(const JobStatus&)>& wanted);
  JobStatus wait_end(const JobId& job, double seconds = 60);
  RunSummary fetch(const JobId& job, Picture& picture);
  /// As fetch(), for calls that may fail.
  grpc::Status try_fetch(const JobId& job, Picture& picture, RunSummary& summary);
  /// Where the server keeps a blob.
  std::string blob_path(const Digest& digest) const;
  /// Files of accepted results in the store: all blobs that begin like one.
  std::vector<std::string> result_files() const;

 private:
  void expect_sound() const;

  std::filesystem::path root_;
  std::string address_;
  std::unique_ptr<Process> server_;
  std::vector<std::unique_ptr<Process>> workers_;
  std::unique_ptr<v1::Render::Stub> render_;
  std::unique_ptr<v1::Blobs::Stub> blobs_;
  std::unique_ptr<v1::Worker::Stub> worker_stub_;
};

double steady_seconds();
/// What times that a test waits at most are multiplied by: PENUMBRA_PATIENCE, for programs that a sanitiser
/// slows down; 1 without.
double patience();

}  // namespace penumbra

#pragma once
// The worker's side of Sync: threads that render leased tiles, and one that tells the server about it.
#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "proto/blob_folder.h"
#include "proto/log.h"
#include "proto/worker.grpc.pb.h"
#include "worker/agent/blob_client.h"
#include "worker/agent/scene_cache.h"
#include "worker/agent/scene_loader.h"
#include "worker/agent/task_board.h"

namespace penumbra {

struct AgentOptions {
  WorkerInfo worker;
  std::string name;  ///< which of the host's workers (proto/worker.proto)
  int threads = 1;
  size_t scenes = 2;  ///< kept loaded
};

class Agent {
 public:
  Agent(AgentOptions options, const std::shared_ptr<grpc::Channel>& channel, BlobFolder cache,
        const SceneLoader& loader);
  ~Agent();

  void start();
  /// Finishes what is begun, hands back the rest, then ends. With `grace_seconds`: what is not done by then
  /// is cancelled and handed back too.
  void drain(std::optional<double> grace_seconds);
  /// It holds no tile and has nothing to report.
  bool idle() const { return board_.empty(); }
  /// True once the agent has ended by itself: drained, or refused by the server.
  bool ended() const { return ended_; }
  /// Ends the threads. OK, or why the server has refused this worker.
  absl::Status stop();

 private:
  struct ToUpload {
    std::shared_ptr<Assignment> assignment;  ///< null: reported already, the server has lost its blob
    std::shared_ptr<Finished> finished;
  };

  void sync_loop();
  bool sync_once();
  bool take_answer(const absl::Status& status, const v1::SyncResponse& response, const WorkerState& told);
  bool drained();
  void render_loop();
  About about(const LeaseId& lease) const;
  absl::StatusOr<TaskOutcome> outcome_of(const Assignment& assignment);
  void hand_in(const std::shared_ptr<Assignment>& assignment, TaskOutcome outcome, std::string log);
  void upload_loop();
  void upload(const ToUpload& item);
  void settle(const ToUpload& item, const absl::Status& status);
  void pause(double seconds);

  AgentOptions options_;
  std::unique_ptr<v1::Worker::Stub> stub_;
  BlobFolder cache_;
  BlobClient blobs_;
  SceneCache scenes_;
  TaskBoard board_;

  std::mutex upload_mutex_;
  std::condition_variable upload_ready_;
  std::deque<ToUpload> uploads_;  // guarded by upload_mutex_

  std::atomic<bool> stopping_{false}, ended_{false}, draining_{false};
  std::atomic<double> deadline_;  ///< of the drain, steady seconds
  bool reachable_ = true;
  absl::Status refusal_;  ///< written by the Sync thread before ended_
  std::thread sync_thread_, upload_thread_;
  std::vector<std::thread> render_threads_;
};

}  // namespace penumbra

#pragma once
// Scenes by the digest of their bundle: fetched once, loaded once, shared by the threads.
#include <condition_variable>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "proto/blob_folder.h"
#include "worker/agent/blob_client.h"
#include "worker/agent/scene_loader.h"

namespace penumbra {

struct CachedScene {
  std::shared_ptr<const RenderableScene> scene;
  LoadReport report;
};

class SceneCache {
 public:
  /// Keeps the `most` scenes that were used last; scenes in use live on in their users' hands.
  SceneCache(const BlobClient& blobs, const BlobFolder& folder, const SceneLoader& loader, int threads,
             size_t most)
      : blobs_(blobs), folder_(folder), loader_(loader), threads_(threads), most_(most) {}

  /// The job's scene; blocks while it is fetched and loaded, by this thread or another. While the server
  /// is away, tries until `give_up` says so (Cancelled). InvalidArgument is the scene's fault and is
  /// remembered; other errors are not.
  absl::StatusOr<CachedScene> get(const JobSpec& job, const std::function<bool()>& give_up);

 private:
  struct Entry {
    Digest bundle;
    bool strict;
    std::vector<std::string> leave_out;
    bool loading = true;
    absl::StatusOr<CachedScene> result = absl::UnknownError("loading");
  };
  using Entries = std::list<std::shared_ptr<Entry>>;

  absl::StatusOr<CachedScene> load(const JobSpec& job, const std::function<bool()>& give_up);

  const BlobClient& blobs_;
  const BlobFolder& folder_;
  const SceneLoader& loader_;
  int threads_;
  size_t most_;
  std::mutex mutex_;
  std::condition_variable loaded_;
  Entries entries_;  ///< the last used first
};

}  // namespace penumbra

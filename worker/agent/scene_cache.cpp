#include "worker/agent/scene_cache.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <thread>

#include "proto/rpc_status.h"
#include "proto/status.h"
#include "scenes/bundle.h"

namespace penumbra {
namespace {

/// Index and blobs of a bundle into the folder.
absl::StatusOr<BundleIndex> fetch_bundle(const BlobClient& blobs, const BlobFolder& folder,
                                         const Digest& bundle) {
  ASSIGN_OR_RETURN(const std::string json, blobs.fetch_small(bundle, folder));
  ASSIGN_OR_RETURN(BundleIndex index, parse_bundle_index(json));
  for (const BundleEntry& entry : index.entries) {
    if (!is_digest(entry.digest)) return invalid_input("bundle: {}: not a digest", entry.name);
    RETURN_IF_ERROR(blobs.fetch(entry.digest, entry.size, folder));
  }
  return index;
}

/// What says that the server's copy of the scene is not whole: DataLoss, whatever it was.
absl::Status lost_input(const absl::Status& status) {
  if (!absl::IsNotFound(status) && !absl::IsDataLoss(status)) return status;
  return make_status(absl::StatusCode::kDataLoss,
                     "the server has lost a file of the scene, submit it again: {}", message_of(status));
}

/// The server is away, or has more callers than it serves at a time (server/listener.cpp).
bool worth_trying_again(const absl::Status& status) {
  return absl::IsUnavailable(status) || is_overload(status);
}

/// Tries again for as long as the server is away or busy.
absl::StatusOr<BundleIndex> fetch_patiently(const BlobClient& blobs, const BlobFolder& folder,
                                            const Digest& bundle, const std::function<bool()>& give_up) {
  for (;;) {
    absl::StatusOr<BundleIndex> index = fetch_bundle(blobs, folder, bundle);
    if (index.ok()) return index;
    if (!worth_trying_again(index.status())) return lost_input(index.status());
    if (give_up()) return absl::CancelledError("given up while the server was away");
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

}  // namespace

absl::StatusOr<CachedScene> SceneCache::load(const JobSpec& job, const std::function<bool()>& give_up) {
  ASSIGN_OR_RETURN(BundleIndex index, fetch_patiently(blobs_, folder_, job.bundle, give_up));
  const std::string main = index.main;
  const BundleFiles files(std::move(index), folder_.root());
  CachedScene out;
  try {
    ASSIGN_OR_RETURN(out.scene, loader_.load(main, files, {threads_, job.strict, job.leave_out}, out.report));
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("out of memory while the scene was loaded (see --max-memory)");
  }
  return out;
}

absl::StatusOr<CachedScene> SceneCache::get(const JobSpec& job, const std::function<bool()>& give_up) {
  std::unique_lock lock(mutex_);
  const auto same = [&](const std::shared_ptr<Entry>& entry) {
    return entry->bundle == job.bundle && entry->strict == job.strict && entry->leave_out == job.leave_out;
  };
  if (const auto it = std::find_if(entries_.begin(), entries_.end(), same); it != entries_.end()) {
    const std::shared_ptr<Entry> entry = *it;
    entries_.splice(entries_.begin(), entries_, it);
    loaded_.wait(lock, [&] { return !entry->loading; });
    return entry->result;
  }
  entries_.push_front(std::make_shared<Entry>(Entry{job.bundle, job.strict, job.leave_out}));
  const std::shared_ptr<Entry> mine = entries_.front();
  lock.unlock();
  absl::StatusOr<CachedScene> result = load(job, give_up);
  lock.lock();
  mine->result = std::move(result);
  mine->loading = false;
  loaded_.notify_all();
  const bool worth_keeping = mine->result.ok() || absl::IsInvalidArgument(mine->result.status());
  if (!worth_keeping) entries_.remove(mine);
  // A scene that is still being loaded is needed by somebody.
  while (entries_.size() > most_ && !entries_.back()->loading) entries_.pop_back();
  return mine->result;
}

}  // namespace penumbra

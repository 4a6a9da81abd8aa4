#pragma once
// The server as the client sees it: one call, one function; retries inside.
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/options.h"
#include "film/film_image.h"
#include "proto/run.h"
#include "scenes/bundle.h"

namespace penumbra {

/// What came of a run: figures and the image of each mix.
struct FetchedRun {
  RunSummary summary;
  double scheduler_cpu_seconds = 0;
  std::vector<FilmImage> images;             ///< one per mix, with all layers
  std::vector<std::vector<FilmImage>> bins;  ///< of each mix, of a job with Transient: mean and variance
};

/// Every call waits through a server that is down or restarting for about 10 s, then is Unavailable
/// ("server HOST:PORT is unreachable: …"). A stopped token makes a call Cancelled.
class Server {
 public:
  /// Asked while the server does not answer; its error ends the waiting (a local server that has died
  /// will not come back).
  using Check = std::function<absl::Status()>;
  static absl::StatusOr<Server> open(const std::string& address, const Credentials& credentials,
                                     Check check = {});
  Server(Server&&) noexcept;
  ~Server();

  /// Uploads what the server lacks of a bundle: its blobs, then its index. Bytes sent are told to
  /// `progress` (sent, of).
  absl::Status upload(const LocalBundle& bundle, std::stop_token stop,
                      const std::function<void(uint64_t, uint64_t)>& progress = {});
  absl::StatusOr<JobId> submit(const JobSpec& spec, std::stop_token stop, const JobTerms& terms = {});
  absl::StatusOr<JobStatus> status(const JobId& job, std::stop_token stop);
  absl::StatusOr<JobStatus> cancel(const JobId& job);
  absl::StatusOr<std::vector<JobStatus>> jobs(std::stop_token stop);
  absl::StatusOr<std::vector<std::string>> explain(const JobId& job, std::stop_token stop);

  /// What became of a job's tasks (or of one tile's), oldest first; with `worker_lines` also what workers
  /// logged while they rendered.
  absl::StatusOr<std::vector<LogLine>> log(const JobId& job, std::optional<uint64_t> tile, bool worker_lines,
                                           std::stop_token stop);

  /// Follows a job to its end; each status is told to `each`, whose error ends the watching. The final
  /// status.
  using EachStatus = std::function<absl::Status(const JobStatus&)>;
  absl::StatusOr<JobStatus> watch(const JobId& job, std::stop_token stop, const EachStatus& each);

  /// The outcome's figures until now, without any pixel.
  absl::StatusOr<RunSummary> summary(const JobId& job, std::stop_token stop);

  /// The outcome until now. `each_checkpoint` (may be empty: then they are not sent) gets the cumulative
  /// RGB image of mix `mix` at summary.mixes[mix].checkpoints[checkpoint], possibly more than once.
  using EachCheckpoint =
      std::function<void(const RunSummary& summary, int mix, int checkpoint, const FilmImage& image)>;
  absl::StatusOr<FetchedRun> fetch(const JobId& job, std::stop_token stop,
                                   const EachCheckpoint& each_checkpoint);

 private:
  struct Parts;
  explicit Server(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace penumbra

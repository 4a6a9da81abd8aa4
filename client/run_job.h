#pragma once
// A job from submission to the files it leaves: what render and replay share.
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "client/job_json.h"
#include "client/local_cluster.h"
#include "client/options.h"
#include "client/server.h"
#include "client/submission.h"

namespace penumbra {

struct FinishedRun {
  Json run;        ///< run.json's content
  JobStatus last;  ///< the final state
  bool interrupted = false;
};

/// The server to use: a new local cluster, or the one named by --server.
struct Backend {
  std::optional<LocalCluster> cluster;
  std::optional<Server> server;

  /// Looks after the local cluster's processes, if there is one.
  absl::Status tend() { return cluster ? cluster->tend() : absl::OkStatus(); }
};
absl::StatusOr<std::unique_ptr<Backend>> open_backend(const ServerOptions& server,
                                                      const ClusterOptions& cluster);
/// A local cluster of another build (its folder, with bin/); empty: of this one.
absl::StatusOr<std::unique_ptr<Backend>> open_local(const ClusterOptions& cluster,
                                                    const std::string& programs);

/// Uploads, submits, follows, fetches, writes. When the token stops, the job is cancelled and what there
/// is of it is written, marked partial. A job that failed is an error after its images are written. `display`:
/// HOST:PORT of a tev that shows the picture while it grows; empty: none.
absl::StatusOr<FinishedRun> run_job(Backend& backend, const Submission& submission, const std::string& folder,
                                    bool quiet, std::stop_token stop, const std::string& display = {});

}  // namespace penumbra

#include "client/preview.h"

#include <spdlog/spdlog.h>

#include <condition_variable>

#include "proto/status.h"

namespace penumbra {
namespace {

// Each look makes the server merge everything again: seldom enough to cost it little.
constexpr std::chrono::seconds kPause{2};

}  // namespace

Preview::Preview(Server& server, JobId job, Tev tev)
    : server_(server),
      job_(std::move(job)),
      tev_(std::move(tev)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Preview::~Preview() {
  thread_.request_stop();
  thread_.join();
}

absl::Status Preview::show_once() {
  ASSIGN_OR_RETURN(const FetchedRun run, server_.fetch(job_, std::stop_token(), {}));
  const std::vector<std::string> names = labels(run.summary.spec.mixes);
  for (size_t m = 0; m < names.size(); ++m)
    if (!run.images[m].rgb.empty()) RETURN_IF_ERROR(tev_.show(names[m], run.images[m]));
  return absl::OkStatus();
}

void Preview::run(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any wake;
  for (bool last = false; !last;) {
    std::unique_lock lock(mutex);
    wake.wait_for(lock, stop, kPause, [] { return false; });
    last = stop.stop_requested();
    const absl::Status status = show_once();
    if (status.ok()) continue;
    spdlog::warn("no more previews: {}", message_of(status));
    return;
  }
}

}  // namespace penumbra

// penumbra-server: flags, folders, services, signals.
#include <malloc.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <map>
#include <thread>

#include "film/atomic_file.h"
#include "proto/log.h"
#include "proto/status.h"
#include "server/blobs_service.h"
#include "server/coordinator.h"
#include "server/http_pages.h"
#include "server/listener.h"
#include "server/postgres_store.h"
#include "server/render_service.h"
#include "server/retention.h"
#include "server/sqlite_store.h"
#include "server/store_folder.h"
#include "server/worker_service.h"

namespace penumbra {
namespace {

constexpr int kFailed = 1, kBadUsage = 2;

struct Options {
  ListenOptions listen{.address = "127.0.0.1:7400", .credentials = {}, .tokens = {}};
  std::string store;
  std::string address_file;
  std::string http;
  std::string database;
  std::string log_level = "info", log_format = "text";
  bool ephemeral = false;
  BlobLimits blobs;
  SchedulerLimits scheduler;
  RetentionLimits retention;
};

Now now() {
  using std::chrono::duration;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return {duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(),
          duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(),
          seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

/// DURATION as everywhere (500ms, 30s, 2m, 1h), given to the option as plain seconds.
CLI::Validator seconds_flag() {
  const std::map<std::string, double> units = {{"ms", 1e-3}, {"s", 1}, {"m", 60}, {"h", 3600}};
  return CLI::AsNumberWithUnit(units, CLI::AsNumberWithUnit::UNIT_REQUIRED, "DURATION");
}

void add_flags(CLI::App& app, Options& options) {
  app.add_option("--listen", options.listen.address, "HOST:PORT; port 0 takes a free one")
      ->capture_default_str();
  app.add_option("--store", options.store, "folder for jobs, scenes and results; a restart continues from it")
      ->required();
  app.add_option(
      "--database", options.database,
      "postgresql://HOST/NAME for jobs instead of a file in --store; of the servers with the same database "
      "and --store one leads, the others stand by");
  app.add_flag("--ephemeral", options.ephemeral,
               "flush nothing to disk: for a store that need not survive the loss of power");
  app.add_option("--address-file", options.address_file, "file to write the bound HOST:PORT to");
  app.add_option("--http", options.http,
                 "HOST:PORT of the dashboard, /metrics and /healthz; port 0 takes a free one");
  app.add_option("--tls-cert", options.listen.credentials.cert, "server certificate, PEM");
  app.add_option("--tls-key", options.listen.credentials.key, "its private key, PEM");
  app.add_option("--tls-ca", options.listen.credentials.ca,
                 "authority that clients' and workers' certificates must have");
  app.add_option(
      "--token-file", options.listen.credentials.token_file,
      "file of the tokens that callers must send, one a line: TOKEN USER ROLES [jobs=N] [tasks=N] [rate=N]");
  app.add_flag("--insecure", options.listen.insecure,
               "let other machines call without TLS and token: only where the network itself can be trusted");
  app.add_option("--reserve", options.blobs.reserve_bytes, "of the store's disk that is kept free, e.g. 256M")
      ->transform(CLI::AsSizeValue(false));
  app.add_option("--keep", options.retention.keep_seconds, "finished jobs for so long, e.g. 720h")
      ->transform(seconds_flag());
  app.add_option("--keep-bytes", options.retention.keep_bytes,
                 "of results, e.g. 100G; above it the oldest finished jobs go")
      ->transform(CLI::AsSizeValue(false));
  app.add_option("--keep-uploads", options.retention.keep_uploads_seconds,
                 "uploads that no job names for so long, e.g. 24h")
      ->transform(seconds_flag());
  app.add_option("--silence", options.scheduler.silence_seconds,
                 "after which a worker has lost its leases, e.g. 10s")
      ->transform(seconds_flag());
  app.add_option("--task-limit", options.scheduler.task_seconds,
                 "after which a task is taken from a worker, e.g. 30m")
      ->transform(seconds_flag());
  app.add_option("--log-level", options.log_level, "trace, debug, info, warning, error or off")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
  app.add_option("--log-format", options.log_format, "text, or json: one object an event")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  app.set_version_flag("--version", "penumbra-server " PENUMBRA_VERSION);
}

/// Waits for SIGTERM or SIGINT (blocked in every thread), or for the store to fail.
void wait_for_end(const Coordinator& coordinator) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  const timespec half_second{0, 500'000'000};
  while (sigtimedwait(&signals, nullptr, &half_second) < 0)
    if (coordinator.failed()) return;
}

void block_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

/// SIGTERM or SIGINT has come (and is consumed).
bool asked_to_end() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  const timespec now{};
  return sigtimedwait(&signals, nullptr, &now) > 0;
}

/// The folder of a leader that has just lost its lead is in its hands until it has noticed and ended.
absl::StatusOr<StoreFolder> take_over_folder(const std::string& path) {
  constexpr std::chrono::milliseconds kPause{100};
  constexpr int kTries = 300;
  for (int tries = 1;; ++tries) {
    absl::StatusOr<StoreFolder> folder = StoreFolder::open(path);
    if (folder.ok()) return folder;
    if (asked_to_end()) return absl::CancelledError("asked to end");
    if (tries == kTries) return absl::UnavailableError(message_of(folder.status()));
    std::this_thread::sleep_for(kPause);
  }
}

absl::Status serve(Options options) {
  if (!options.listen.credentials.token_file.empty()) {
    ASSIGN_OR_RETURN(options.listen.tokens, read_token_file(options.listen.credentials.token_file));
  }
  for (const TokenEntry& entry : options.listen.tokens) options.scheduler.quotas[entry.user] = entry.quota;
  const Durability durability = options.ephemeral ? Durability::kProcessEnd : Durability::kPowerLoss;
  std::unique_ptr<JobStore> store;
  // Who stands by must not hold the folder that the leader works in.
  if (!options.database.empty()) {
    ASSIGN_OR_RETURN(store, open_postgres_store(options.database, durability, asked_to_end));
  }
  ASSIGN_OR_RETURN(const StoreFolder folder,
                   store == nullptr ? StoreFolder::open(options.store) : take_over_folder(options.store));
  if (store == nullptr) {
    ASSIGN_OR_RETURN(store, open_sqlite_store(folder.database(), durability));
  } else if (std::filesystem::exists(folder.database())) {
    // Its jobs would be out of sight, and retention would take their blobs.
    return invalid_input(
        "--database: {} was used without it and has jobs of its own in {}: give another --store, "
        "or delete that file together with its jobs",
        options.store, folder.database());
  }
  ASSIGN_OR_RETURN(BlobFolder blobs, BlobFolder::open(folder.blobs(), durability));
  Coordinator coordinator(std::move(store), std::move(blobs), options.scheduler, now);
  RETURN_IF_ERROR(coordinator.start());

  BlobsService blobs_service(coordinator.blobs(), options.blobs);
  RenderService render_service(coordinator);
  WorkerService worker_service(coordinator, options.blobs);
  ASSIGN_OR_RETURN(Listener listener,
                   listen(options.listen, {&blobs_service, &render_service, &worker_service}));
  HttpPages pages(coordinator);
  HttpServer http;
  if (!options.http.empty()) {
    ListenOptions http_options = options.listen;
    http_options.address = options.http;
    ASSIGN_OR_RETURN(http, HttpServer::start(std::move(http_options), [&](const HttpRequest& request) {
                       return pages.answer(request);
                     }));
    spdlog::info("dashboard on {}", http.url());
  }
  if (!options.address_file.empty())
    RETURN_IF_ERROR(write_file_atomically(options.address_file, listener.address + "\n"));
  spdlog::info("listening on {}, store {}", listener.address, options.store);

  auto retention = std::make_unique<Retention>(coordinator, options.retention);
  wait_for_end(coordinator);
  const bool failed = coordinator.failed();
  spdlog::info("stopping");
  // Waiting workers are answered first: their calls would otherwise hold up the shutdown.
  coordinator.stop();
  retention.reset();
  listener.server->Shutdown(std::chrono::system_clock::now() + std::chrono::seconds(1));
  if (failed) return absl::InternalError("the job store failed");
  return absl::OkStatus();
}

/// Results come and go by the hundred kilobytes: given back to the kernel each time, most of the time of
/// receiving one would go into getting zeroed pages again.
void keep_freed_memory() {
  constexpr int kKept = 64 << 20, kLargestKept = 16 << 20;
  mallopt(M_TRIM_THRESHOLD, kKept);
  mallopt(M_MMAP_THRESHOLD, kLargestKept);
}

int run(int argc, char** argv) {
  keep_freed_memory();
  Options options;
  CLI::App app(
      "Coordinates render jobs: splits them into tiles, leases the tiles to workers, keeps the results.");
  add_flags(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadUsage;
  }
  start_log("server", options.log_level, options.log_format == "json" ? LogFormat::kJson : LogFormat::kText);
  block_signals();
  const absl::Status status = serve(options);
  if (status.ok() || absl::IsCancelled(status)) return 0;
  spdlog::error("{}", message_of(status));
  return absl::IsInvalidArgument(status) ? kBadUsage : kFailed;
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  return penumbra::run(argc, argv);
}

#include "worker/agent/program.h"

#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "proto/channel.h"
#include "proto/log.h"
#include "proto/status.h"
#include "worker/agent/agent.h"
#include "worker/agent/flags.h"
#include "worker/agent/identity.h"
#include "worker/agent/log_capture.h"

namespace penumbra {
namespace {

constexpr int kFailed = 1, kBadUsage = 2;
// On SIGTERM a tile that is being rendered may still be finished within this.
constexpr double kGraceSeconds = 3.5;

struct Options {
  std::string server;
  int threads = 0;
  std::string cache, name, max_memory, drain_after, drain_idle;
  std::string log_level = "info", log_format = "text";
  Credentials credentials;
};

void add_flags(CLI::App& app, Options& options) {
  app.add_option("--server", options.server, "HOST:PORT of penumbra-server")->required();
  app.add_option("--threads", options.threads, "threads that render; default: one per core")
      ->check(CLI::Range(1, 4096));
  app.add_option(
      "--cache", options.cache,
      "folder for scene files, shared by the workers of a host; default: $XDG_CACHE_HOME/penumbra");
  app.add_option("--name", options.name,
                 "which of the host's workers this is; default: the lowest number free in the cache folder");
  app.add_option("--max-memory", options.max_memory, "e.g. 8G; a scene that needs more fails its job");
  app.add_option("--drain-after", options.drain_after, "e.g. 50m; then take no new tiles, finish, and end");
  app.add_option(
      "--drain-idle", options.drain_idle,
      "e.g. 60s; end after so long without a tile: for workers that a farm's scheduler starts on demand");
  app.add_option("--tls-cert", options.credentials.cert, "this worker's certificate, PEM");
  app.add_option("--tls-key", options.credentials.key, "its private key, PEM");
  app.add_option("--tls-ca", options.credentials.ca, "authority that the server's certificate must have");
  app.add_option("--token-file", options.credentials.token_file, "file with the token to send");
  app.add_option("--log-level", options.log_level, "trace, debug, info, warning, error or off")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
  app.add_option("--log-format", options.log_format, "text, or json: one object an event")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  app.set_version_flag("--version", "penumbra-worker " PENUMBRA_VERSION);
}

absl::StatusOr<std::string> cache_folder(const std::string& given) {
  if (!given.empty()) return given;
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg != '\0')
    return std::string(xdg) + "/penumbra";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::string(home) + "/.cache/penumbra";
  return invalid_input("--cache: give a folder; neither XDG_CACHE_HOME nor HOME is set");
}

/// A scene that is too large must end in an allocation that fails, not in a host that swaps.
absl::Status limit_memory(const std::string& text) {
  if (text.empty()) return absl::OkStatus();
  ASSIGN_OR_RETURN(const uint64_t bytes, parse_bytes_flag("--max-memory", text));
  const rlimit limit{bytes, bytes};
  if (setrlimit(RLIMIT_DATA, &limit) != 0) return invalid_input("--max-memory: {} cannot be set", text);
  return absl::OkStatus();
}

void block_signals(sigset_t& signals) {
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

/// When a worker goes by itself; seconds.
struct Leaving {
  std::optional<double> after;  ///< since its start
  std::optional<double> idle;   ///< since it last held a tile
};

absl::StatusOr<Leaving> leaving_of(const Options& options) {
  Leaving leaving;
  if (!options.drain_after.empty()) {
    ASSIGN_OR_RETURN(leaving.after, parse_duration_flag("--drain-after", options.drain_after));
  }
  if (!options.drain_idle.empty()) {
    ASSIGN_OR_RETURN(leaving.idle, parse_duration_flag("--drain-idle", options.drain_idle));
  }
  return leaving;
}

/// Until the agent has ended by itself, been asked to, or come to its time.
void supervise(Agent& agent, Leaving leaving, const sigset_t& signals) {
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  const auto start = Clock::now();
  auto last_busy = start;
  const timespec slice{0, 100'000'000};
  while (!agent.ended()) {
    if (sigtimedwait(&signals, nullptr, &slice) > 0) {
      spdlog::info("draining: asked to stop");
      agent.drain(kGraceSeconds);
      leaving = {};
    }
    if (!agent.idle()) last_busy = Clock::now();
    const bool time_is_up = leaving.after && since(start) >= *leaving.after;
    if (!time_is_up && !(leaving.idle && since(last_busy) >= *leaving.idle)) continue;
    spdlog::info("draining: {} has passed", time_is_up ? "--drain-after" : "--drain-idle");
    agent.drain(std::nullopt);
    leaving = {};
  }
}

absl::Status work(const Options& options, const SceneLoader& loader) {
  sigset_t signals;
  block_signals(signals);
  ASSIGN_OR_RETURN(const Leaving leaving, leaving_of(options));
  RETURN_IF_ERROR(limit_memory(options.max_memory));
  ASSIGN_OR_RETURN(const std::string folder, cache_folder(options.cache));
  // What power takes away is fetched again: every file is verified before it is believed (blob_client.h).
  ASSIGN_OR_RETURN(BlobFolder cache, BlobFolder::open(folder, Durability::kProcessEnd));
  std::optional<Slot> slot;
  AgentOptions agent_options;
  agent_options.threads = options.threads > 0
                              ? options.threads
                              : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  agent_options.worker = make_worker_info(agent_options.threads);
  agent_options.name = options.name;
  if (options.name.empty()) {
    ASSIGN_OR_RETURN(Slot taken, Slot::take(folder));
    agent_options.name = fmt::format("{}#{}", std::filesystem::absolute(folder).string(), taken.number());
    slot.emplace(std::move(taken));
  }
  ASSIGN_OR_RETURN(const auto channel, open_channel(options.server, options.credentials));
  spdlog::info("worker {} on {}, {} threads, for {}", agent_options.name, agent_options.worker.host,
               agent_options.threads, options.server);
  Agent agent(std::move(agent_options), channel, std::move(cache), loader);
  agent.start();
  supervise(agent, leaving, signals);
  return agent.stop();
}

}  // namespace

int run_worker(int argc, char** argv, const SceneLoader& loader) {
  Options options;
  CLI::App app("Renders the tiles that penumbra-server leases to it.");
  add_flags(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadUsage;
  }
  start_log("worker", options.log_level, options.log_format == "json" ? LogFormat::kJson : LogFormat::kText,
            {make_capture_sink()});
  const absl::Status status = work(options, loader);
  if (status.ok()) return 0;
  spdlog::error("{}", message_of(status));
  return absl::IsInvalidArgument(status) ? kBadUsage : kFailed;
}

}  // namespace penumbra

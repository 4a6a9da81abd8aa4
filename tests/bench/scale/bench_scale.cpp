// One server under the load of a farm that is simulated: leases and results a second with durable commits,
// CPU of the server for each, its memory. The simulation shares the machine with the server, so that rates
// are lower bounds; CPU per tile is the server's own.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "proto/channel.h"
#include "proto/convert.h"
#include "proto/render.grpc.pb.h"
#include "scenes/bundle.h"
#include "tests/bench/scale/server_process.h"
#include "tests/bench/scale/simulated_workers.h"

namespace penumbra {
namespace {

struct Options {
  SimulationOptions simulation;
  int jobs = 4, tile = 64, width = 1920, height = 1080, mixes = 2;
  int64_t passes = 16;
  double seconds = 20;
  std::string folder = std::filesystem::temp_directory_path() / "penumbra-bench-scale";
};

void upload(v1::Blobs::Stub& blobs, const std::string& bytes) {
  grpc::ClientContext context;
  v1::UploadResponse response;
  const auto writer = blobs.Upload(&context, &response);
  v1::UploadChunk chunk;
  chunk.set_digest(sha256(bytes));
  chunk.set_size(bytes.size());
  chunk.set_data(bytes);
  writer->Write(chunk);
  writer->WritesDone();
  writer->Finish();
}

/// Jobs of a scene that nobody will read; the tasks that they have in all.
uint64_t submit_jobs(const Options& o, const std::string& address) {
  const auto channel = *open_channel(address, {});
  const auto blobs = v1::Blobs::NewStub(channel);
  const auto render = v1::Render::NewStub(channel);
  BundleIndex index;
  index.main = "scene.pbrt";
  index.entries = {{"scene.pbrt", "scene.pbrt", sha256("x"), 1}};
  upload(*blobs, "x");
  upload(*blobs, serialize(index));
  JobSpec spec;
  spec.scene = "/scene.pbrt";
  spec.bundle = sha256(serialize(index));
  for (int m = 0; m < o.mixes; ++m) spec.mixes.push_back(*parse_mix("sa:1"));
  spec.budget = SppBudget{o.passes};
  spec.width = o.width;
  spec.height = o.height;
  spec.crop = {0, 0, o.width, o.height};
  spec.tile = o.tile;
  uint64_t tasks = 0;
  for (int i = 0; i < o.jobs; ++i) {
    v1::SubmitRequest request;
    *request.mutable_spec() = to_proto(spec);
    request.set_request_id("job " + std::to_string(i));
    v1::SubmitResponse response;
    grpc::ClientContext context, asking;
    const grpc::Status made = render->Submit(&context, request, &response);
    if (!made.ok()) std::fprintf(stderr, "submit: %s\n", made.error_message().c_str());
    v1::JobRequest job;
    job.set_job(response.job());
    v1::JobStatus status;
    render->GetJob(&asking, job, &status);
    tasks += status.tasks_total();
  }
  return tasks;
}

void run(Options o) {
  std::filesystem::remove_all(o.folder);
  std::filesystem::create_directories(o.folder);
  {
    const ServerProcess server(o.folder, {"--reserve", "64M"});
    o.simulation.address = server.address();
    const uint64_t tasks = submit_jobs(o, server.address());
    const SimulatedWorkers workers(o.simulation);
    const SimulationCounts& counts = workers.counts();
    std::this_thread::sleep_for(std::chrono::seconds(2));  // until everybody has called
    const double cpu = server.cpu_seconds();
    const uint64_t leases = counts.leases, accepted = counts.accepted, bytes = counts.result_bytes,
                   syncs = counts.syncs;
    const auto start = std::chrono::steady_clock::now();
    std::this_thread::sleep_for(std::chrono::duration<double>(o.seconds));
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    const auto done = static_cast<double>(counts.accepted - accepted);
    const double spent = server.cpu_seconds() - cpu;
    const nlohmann::json out = {
        {"workers", o.simulation.workers},
        {"tasks", tasks},
        {"seconds", wall.count()},
        {"leases_per_second", static_cast<double>(counts.leases - leases) / wall.count()},
        {"accepted_per_second", done / wall.count()},
        {"result_bytes_per_second", static_cast<double>(counts.result_bytes - bytes) / wall.count()},
        {"syncs_per_second", static_cast<double>(counts.syncs - syncs) / wall.count()},
        {"failed_syncs", counts.failed_syncs.load()},
        {"server_cpu_share", spent / wall.count()},
        {"server_cpu_microseconds_per_tile", done > 0 ? 1e6 * spent / done : 0.0},
        {"server_resident_mib", server.resident_bytes() / (1 << 20)}};
    std::printf("%s\n", out.dump(2).c_str());
    std::fflush(stdout);
  }
  std::filesystem::remove_all(o.folder);
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  penumbra::Options options;
  CLI::App app("Load of a simulated farm on one server.");
  app.add_option("--workers", options.simulation.workers)->capture_default_str();
  app.add_option("--channels", options.simulation.channels)->capture_default_str();
  app.add_option("--uploaders", options.simulation.uploaders)->capture_default_str();
  app.add_option("--task-seconds", options.simulation.task_seconds)->capture_default_str();
  app.add_option("--jobs", options.jobs)->capture_default_str();
  app.add_option("--width", options.width)->capture_default_str();
  app.add_option("--height", options.height)->capture_default_str();
  app.add_option("--tile", options.tile)->capture_default_str();
  app.add_option("--mixes", options.mixes)->capture_default_str();
  app.add_option("--spp", options.passes)->capture_default_str();
  app.add_option("--seconds", options.seconds)->capture_default_str();
  app.add_option("--folder", options.folder, "for the store; emptied")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  penumbra::run(options);
  return 0;
}

// Writes the kept inputs of the wire's targets with the product's own serialisers: `fuzz_wire_seeds
// tests/fuzz/corpus` after a message has changed. Those that a fuzzer has found are left as they are.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "client/job_json.h"
#include "film/tile_pixels.h"
#include "proto/blobs.pb.h"
#include "proto/convert.h"
#include "proto/sha256.h"
#include "proto/status.h"

namespace penumbra {
namespace {

std::filesystem::path root;

void keep(const std::string& target, const std::string& name, const std::string& bytes) {
  std::filesystem::create_directories(root / target);
  std::ofstream(root / target / name, std::ios::binary) << bytes;
}

JobSpec small_job(const std::vector<std::string>& mixes, const Budget& budget) {
  JobSpec spec;
  spec.scene = "/s";
  spec.bundle = Digest(64, 'a');
  for (const std::string& mix : mixes) spec.mixes.push_back(*parse_mix(mix));
  spec.budget = budget;
  spec.width = 8;
  spec.height = 4;
  spec.crop = {0, 0, 8, 4};
  spec.tile = 4;
  return spec;
}

/// Two tiles, the plan of a run in stages, one mix planned by tile.
JobSpec planned_job() {
  JobSpec spec = small_job({"sa:1", "auto"}, CpuSecondsBudget{1});
  spec.plan = {8, 8};
  spec.auto_plans = {{1, {*parse_mix("sa:1")}, {{0, 8, {255}}, {0, 8}}}};
  spec.earlier_plans = {{0.5, {6, 6}, {{6, 6}}}};
  return spec;
}

JobSpec full_job() {
  JobSpec spec = small_job({"bsdf:1+line-sa@v:3/smooth=0.25"}, TargetErrorBudget{0.5});
  spec.camera_grid = 2;
  spec.regions = {{"r", {1, 1, 2, 2}}};
  spec.leave_out = {"lens"};
  spec.transient = Transient{0, 2, 2};
  return spec;
}

MixCost full_cost() {
  MixCost cost{2, 0.25, 9, 1, 0, 3.5, {7, 0.125}, 16, 7.25, 4, 1e3, 0.125, 1, 0.5, 0};
  cost.blocks = {{0.5f, 0.25f}};
  return cost;
}

WorkerState full_state() {
  WorkerState state{"1", {"w", "h", "avx2", 2}, "0"};
  state.held = {{{"j0", 0, 1}, true}};
  state.completed = {{{"j0", 1, 1}, "", "", {full_cost()}, "log"}};
  state.failed = {{{"j0", 2, 1}, TaskFailure::kError, "why", "log"}};
  state.loaded = {{"j0", {0.5, 0.5, {{"lens", "s:1:1"}}, {"w"}}, {{0, "line-sa@v on 1 light: sa"}}}};
  state.wanted = 2;
  state.known_jobs = {"j0"};
  state.process_cpu_seconds = 1;
  return state;
}

JobStatus full_status() {
  JobStatus status;
  status.job = "j0";
  status.state = JobState::kFailed;
  status.failure = FailureKind::kBadInput;
  status.message = "s:1:1: no";
  status.fraction = 0.5;
  status.plan = {8, 8};
  status.terms = {"u", 1, {"k=v"}, {"j1"}};
  return status;
}

RunSummary full_summary() {
  RunSummary summary;
  summary.status = full_status();
  summary.spec = planned_job();
  for (const Mix& mix : summary.spec.mixes) {
    summary.mixes.emplace_back();
    summary.mixes.back().mix = mix;
    summary.mixes.back().checkpoints = {{1, 0.5}};
  }
  summary.tiles = {{{0, 0, 4, 4}, 1, 8, 0.5, "w", {1, 0.5}}};
  summary.workers = {full_state().worker};
  return summary;
}

/// The first byte says which message: their order is messages_fuzz.cpp's.
void keep_messages() {
  DesiredState desired;
  const LeaseId lease{"j0", 0, 1};
  TileTask task{0, TaskKind::kRun, {0, 0, 4, 4}, {{0, 8}, {0, 8}}, 4, 9};
  task.chosen = {{1, *parse_mix("sa:1"), 4, {255}}};
  task.repilot = {{0, 1}, {0, 0}};
  desired.leases = {{lease, task}};
  desired.jobs = {{"j0", planned_job()}};
  desired.acknowledged = {lease};
  const std::vector<std::pair<std::string, std::string>> messages = {
      {"job_spec", to_proto(full_job()).SerializeAsString()},
      {"job_terms", to_proto(full_status().terms).SerializeAsString()},
      {"sync_request", to_proto(full_state()).SerializeAsString()},
      {"sync_response", to_proto(desired).SerializeAsString()},
      {"job_status", to_proto(full_status()).SerializeAsString()},
      {"run_summary", to_proto(full_summary()).SerializeAsString()},
      {"log_line", to_proto(LogLine{1, 2, "h/0", "text"}).SerializeAsString()},
      {"tile_task", to_proto(task).SerializeAsString()},
      {"load_report", to_proto(full_state().loaded[0].report).SerializeAsString()},
      {"worker_info", to_proto(full_state().worker).SerializeAsString()},
      {"mix_cost", to_proto(full_cost()).SerializeAsString()},
      {"mix_summary", to_proto(full_summary().mixes[0]).SerializeAsString()},
      {"tile_row", to_proto(full_summary().tiles[0]).SerializeAsString()},
      {"pixel_rect", to_proto(PixelRect{1, 2, 3, 4}).SerializeAsString()}};
  for (size_t i = 0; i < messages.size(); ++i)
    keep("wire_messages", messages[i].first, static_cast<char>(i) + messages[i].second);
  keep("wire_messages", "job_spec_planned", '\0' + to_proto(planned_job()).SerializeAsString());
}

void keep_results() {
  const std::vector<float> three(3, 0.5f), one(1, 2.f);
  const TilePixels whole{{0, 0, 1, 1}, 4, 2, {}, {}, three, three, one};
  TilePixels blocks = whole, bins = whole;
  blocks.block_passes = {2};
  blocks.block_groups = {1};
  bins.bins = 1;
  bins.bin_mean = bins.bin_m2 = three;
  keep("wire_tile_result", "two_mixes", serialize({{whole, whole}}));
  keep("wire_tile_result", "blocks", serialize({{blocks}}));
  keep("wire_tile_result", "bins", serialize({{bins}}));
  keep("wire_tile_result", "no_passes", serialize({{TilePixels{{0, 0, 1, 1}}}}));
}

/// A step of requests_fuzz.cpp, or a chunk of frames_fuzz.cpp without the byte that says which.
std::string sized(const std::string& bytes) {
  PENUMBRA_CHECK(bytes.size() < 256);
  return static_cast<char>(bytes.size()) + bytes;
}

void keep_frames() {
  const auto chunk = [](const PixelRect& rect, bool final, int bin, bool last) {
    v1::FrameChunk out;
    *out.mutable_rect() = to_proto(rect);
    out.set_final(final);
    out.set_bin(bin);
    out.set_last(last);
    const auto pixels = static_cast<int>(rect.area());
    for (int i = 0; i < 3 * pixels; ++i) out.add_mean(1);
    for (int i = 0; final && i < 3 * pixels; ++i) out.add_variance(1);
    for (int i = 0; final && bin == 0 && i < pixels; ++i) {
      out.add_samples(1);
      out.add_cost(1);
    }
    return sized(out.SerializeAsString());
  };
  const PixelRect whole{1, 2, 3, 4}, upper{1, 2, 3, 3}, lower{1, 3, 3, 4};
  keep("wire_frames", "whole", chunk(whole, true, 0, true));
  keep("wire_frames", "bin", chunk(whole, true, 1, true));
  keep("wire_frames", "checkpoint_in_two", chunk(upper, false, 0, false) + chunk(lower, false, 0, true));
  keep("wire_frames", "half", chunk(upper, false, 0, true));
}

std::string step(int kind, const std::string& bytes = {}) {
  return static_cast<char>(kind) + sized(bytes);
}

std::string submit(JobSpec spec, const std::string& request, const JobTerms& terms = {}) {
  v1::SubmitRequest message;
  *message.mutable_spec() = to_proto(spec);
  message.mutable_spec()->set_bundle("b");
  message.set_request_id(request);
  *message.mutable_terms() = to_proto(terms);
  return step(0, message.SerializeAsString());
}

void keep_requests() {
  std::string work, ask, frames;
  for (int i = 0; i < 6; ++i) work += step(11);  // enough to finish all but the longest
  v1::JobRequest job;
  job.set_job("j0");
  ask = step(1, job.SerializeAsString());
  v1::FetchFramesRequest fetch;
  fetch.set_job("j0");
  const std::string end = ask + step(3) + step(5, fetch.SerializeAsString());
  keep("wire_requests", "passes", submit(small_job({"sa:1", "bsdf:1"}, SppBudget{8}), "r") + work + end);
  keep("wire_requests", "seconds", submit(small_job({"sa:1"}, CpuSecondsBudget{4}), "r") + work + end);
  keep("wire_requests", "error", submit(small_job({"sa:1"}, TargetErrorBudget{1}), "r") + work + end);
  keep("wire_requests", "auto", submit(small_job({"auto"}, CpuSecondsBudget{4}), "r") + work + end);
  keep("wire_requests", "auto_passes", submit(small_job({"auto"}, SppBudget{64}), "r") + work + end);
  keep("wire_requests", "auto_error", submit(small_job({"auto"}, TargetErrorBudget{1}), "r") + work + end);
  keep("wire_requests", "longest",
       submit(small_job({"sa:1", "auto"}, CpuSecondsBudget{1e300}), "r") + work + end);
  keep("wire_requests", "least_error",
       submit(small_job({"sa:1", "auto"}, TargetErrorBudget{1e-300}), "r") + work + end);
  keep("wire_requests", "planned", submit(planned_job(), "r") + work + end);
  keep("wire_requests", "bins", submit(full_job(), "r") + work + step(13, "") + end);
  const std::string first = submit(small_job({"sa:1"}, SppBudget{1}), "r", {"u", 1, {"k=v"}, {}});
  const std::string second = submit(small_job({"sa:1"}, SppBudget{1}), "q", {"u", 2, {}, {"j0"}});
  keep("wire_requests", "cancelled", first + second + ask + step(2, job.SerializeAsString()) + step(3));
  keep("wire_requests", "silence", first + step(11) + step(12, std::string(20, ' ')) + work + end);
  WorkerState stranger = full_state();
  stranger.loaded.clear();
  keep("wire_requests", "stranger", first + step(6, to_proto(stranger).SerializeAsString()) + end);
  v1::LogRequest log;
  log.set_job("j0");
  log.set_tile(1);
  keep("wire_requests", "log", first + work + step(4, log.SerializeAsString()) + step(13, " "));
  v1::UploadChunk head, rest;
  head.set_digest("b");
  head.set_size(2);
  head.set_data("a");
  rest.set_data("b");
  v1::FindMissingRequest missing;
  missing.add_digests(sha256("ab"));
  v1::DownloadRequest download;
  download.set_digest(sha256("ab"));
  download.set_offset(1);
  keep("wire_requests", "blob",
       step(8, head.SerializeAsString()) + step(8, rest.SerializeAsString()) +
           step(7, missing.SerializeAsString()) + step(9) + step(7, missing.SerializeAsString()) +
           step(10, download.SerializeAsString()));
}

void keep_texts() {
  const auto run = [](const JobSpec& spec) {
    return Json{{"spec", to_json(spec)}, {"plan", std::vector<int>(spec.mixes.size(), 8)}}.dump();
  };
  keep("wire_run_json", "passes", run(small_job({"sa:1"}, SppBudget{8})));
  keep("wire_run_json", "full", run(full_job()));
  keep("wire_run_json", "stages", run(planned_job()));
  keep("wire_token_file", "one", "secret\n");
  keep("wire_token_file", "roles",
       "# farm\nsecret ann submit,admin jobs=2 tasks=8 rate=3\n\nother farm work\n");
  keep("wire_token_file", "twice", "secret ann submit\nsecret bob work\n");
  keep("wire_token_file", "no_number", "secret ann submit jobs=99999999999999999999\n");
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s tests/fuzz/corpus\n", argv[0]);
    return 2;
  }
  penumbra::root = argv[1];
  penumbra::keep_messages();
  penumbra::keep_results();
  penumbra::keep_frames();
  penumbra::keep_requests();
  penumbra::keep_texts();
  return 0;
}

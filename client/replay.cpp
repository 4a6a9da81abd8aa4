#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <memory>

#include "client/commands.h"
#include "client/exit_code.h"
#include "client/outcome.h"
#include "client/run_job.h"
#include "film/exr.h"
#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

struct ReplayOptions {
  std::string run;
  bool verify = false;
  ServerOptions server;
  ClusterOptions cluster;
  OutputOptions output;
};

/// Beside the run's folder, so that the run itself stays as it is.
std::string replay_folder(const ReplayOptions& o) {
  if (!o.output.out.empty()) return o.output.out;
  const fs::path folder = fs::absolute(o.run).lexically_normal().parent_path();
  return folder.string() + "-replay";
}

int64_t different_pixels(const FilmImage& a, const FilmImage& b) {
  int64_t different = 0;
  for (size_t p = 0; p < a.pixels(); ++p)
    different += std::memcmp(&a.rgb[3 * p], &b.rgb[3 * p], 3 * sizeof(float)) != 0;
  return different;
}

/// The picture of a file, and the bins of path length behind it.
absl::StatusOr<std::vector<FilmImage>> read_all(const fs::path& path, bool bins) {
  ASSIGN_OR_RETURN(FilmImage image, read_exr(path));
  std::vector<FilmImage> all(1, std::move(image));
  if (!bins) return all;
  ASSIGN_OR_RETURN(ExrBins more, read_exr_bins(path));
  std::move(more.images.begin(), more.images.end(), std::back_inserter(all));
  return all;
}

/// Aborted if any bit of R G B differs in any image, or in any bin of one.
absl::Status verify(const Json& before, const fs::path& old_folder, const Json& after,
                    const fs::path& new_folder) {
  const bool bins = !after["transient"].is_null();
  for (size_t m = 0; m < after["mixes"].size(); ++m) {
    const std::string label = after["mixes"][m]["mix"].get<std::string>();
    ASSIGN_OR_RETURN(const std::vector<FilmImage> a,
                     read_all(old_folder / before["mixes"][m]["image"].get<std::string>(), bins));
    ASSIGN_OR_RETURN(const std::vector<FilmImage> b,
                     read_all(new_folder / after["mixes"][m]["image"].get<std::string>(), bins));
    if (a.size() != b.size() || a[0].width != b[0].width || a[0].height != b[0].height ||
        a[0].window != b[0].window)
      return make_status(absl::StatusCode::kAborted, "{}: the images have different sizes", label);
    int64_t different = 0;
    for (size_t i = 0; i < a.size(); ++i) different += different_pixels(a[i], b[i]);
    if (different > 0)
      return make_status(absl::StatusCode::kAborted, "{}: {} of {} pixels differ", label, different,
                         a[0].pixels() * a.size());
  }
  return absl::OkStatus();
}

absl::StatusOr<FinishedRun> replay(const ReplayOptions& o, const std::string& folder, std::stop_token stop) {
  ASSIGN_OR_RETURN(const Json before, read_json(o.run));
  const absl::StatusOr<JobSpec> spec = replay_spec(before);
  if (!spec.ok()) return invalid_input("{}: {}", o.run, message_of(spec.status()));
  const fs::path old_folder = fs::absolute(o.run).parent_path();
  std::error_code ignored;  // the new folder need not exist
  if (fs::equivalent(old_folder, folder, ignored))
    return invalid_input("--out: {} holds the run that is replayed", folder);
  ASSIGN_OR_RETURN(const Submission submission, prepare_again(*spec));
  ASSIGN_OR_RETURN(const std::unique_ptr<Backend> backend, open_backend(o.server, o.cluster));
  ASSIGN_OR_RETURN(FinishedRun finished, run_job(*backend, submission, folder, o.output.quiet, stop));
  if (o.verify && !finished.interrupted) RETURN_IF_ERROR(verify(before, old_folder, finished.run, folder));
  return finished;
}

}  // namespace

void add_replay(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand("replay", "Render a run again with its stored plan: the same bits");
  auto options = std::make_shared<ReplayOptions>();
  command->add_option("run", options->run)->required()->type_name("run.json");
  command->add_flag("--verify", options->verify,
                    "Compare bit for bit with the run's images; exit code 1 if they differ");
  add_output_options(*command, options->output);
  command->get_option("--out")->description("Folder for the replay (default: the run's folder with -replay)");
  add_cluster_options(*command, options->cluster);
  add_server_options(*command, options->server, false);
  command->callback([options, &chosen] {
    chosen.run = [options](std::stop_token stop) {
      const std::string folder = replay_folder(*options);
      const absl::StatusOr<FinishedRun> finished = replay(*options, folder, stop);
      if (!finished.ok()) return tell(finished.status());
      const OutputOptions& output = options->output;
      if (output.json)
        fmt::print("{}", json_text(finished->run));
      else if (!output.quiet)
        fmt::print("{}", outcome_text(finished->run, folder));
      if (finished->interrupted) return static_cast<int>(kExitInterrupted);
      if (options->verify && !output.json && !output.quiet)
        fmt::print("verified: every pixel is the same, bit for bit\n");
      return static_cast<int>(kExitDone);
    };
  });
}

}  // namespace penumbra

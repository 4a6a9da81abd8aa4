#include "client/outcome.h"

#include <filesystem>
#include <set>

#include "client/checkpoint_errors.h"
#include "client/output_folder.h"
#include "client/report.h"
#include "film/atomic_file.h"
#include "film/exr.h"
#include "film/own_error.h"
#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

absl::Status measure(const FilmImage& image, const FilmImage& reference, const JobSpec& spec,
                     MixRecord& record) {
  ASSIGN_OR_RETURN(record.error, compare(image, reference));
  for (const Region& region : spec.regions) {
    ASSIGN_OR_RETURN(ErrorFigures figures, compare(image, reference, region.rect));
    record.regions.emplace_back(region.name, std::move(figures));
  }
  return absl::OkStatus();
}

absl::Status write_images(const fs::path& folder, const FetchedRun& fetched,
                          const std::optional<FilmImage>& reference, RunRecord& run) {
  absl::Status measured;  // a comparison that fails must not cost the images that follow
  const JobSpec& spec = fetched.summary.spec;
  const std::vector<std::string> names = labels(spec.mixes);
  for (size_t m = 0; m < names.size(); ++m) {
    MixRecord& record = run.mixes[m];
    record.label = names[m];
    record.image = image_name(names[m]);
    const FilmImage& image = fetched.images[m];
    const auto missing = [](const FilmImage& i) { return i.rgb.empty(); };
    if (missing(image) || std::any_of(fetched.bins[m].begin(), fetched.bins[m].end(), missing))
      return absl::DataLossError("the server did not send all images of " + names[m]);
    RETURN_IF_ERROR(write_exr(
        folder / record.image, image,
        {names[m], fetched.summary.mixes[m].cpu_seconds, spec.scene, spec.seed, run.partial, spec.transient},
        fetched.bins[m]));
    record.own_error = own_error(image);
    if (reference) measured.Update(measure(image, *reference, spec, record));
  }
  return measured;
}

}  // namespace

absl::StatusOr<FilmImage> read_reference(const JobSpec& spec) {
  absl::StatusOr<FilmImage> image = read_exr(spec.reference);
  if (!image.ok()) return make_status(image.status().code(), "--reference: {}", message_of(image.status()));
  if (image->width != spec.width || image->height != spec.height)
    return invalid_input("--reference: {} is {}x{}, the image {}x{}", spec.reference, image->width,
                         image->height, spec.width, spec.height);
  if (!contains(image->window, spec.crop))
    return invalid_input("--reference: {} does not cover the rendered pixels", spec.reference);
  return image;
}

absl::StatusOr<Json> write_outcome(Server& server, const JobId& job, const std::string& folder, bool partial,
                                   std::stop_token stop) {
  RunRecord run;
  run.partial = partial;
  // The reference is named by the job itself.
  ASSIGN_OR_RETURN(const RunSummary before, server.summary(job, stop));
  RETURN_IF_ERROR(prepare_folder(folder));
  RETURN_IF_ERROR(check_reference_stays(before.spec, folder));
  std::optional<FilmImage> reference;
  absl::Status fault;  // told at the end: everything that can be written is written
  if (!before.spec.reference.empty()) {
    absl::StatusOr<FilmImage> read = read_reference(before.spec);
    fault.Update(read.status());
    if (read.ok()) reference = *std::move(read);
  }
  CheckpointErrors checkpoints;
  const auto each_checkpoint = [&](const RunSummary& summary, int mix, int checkpoint,
                                   const FilmImage& image) {
    checkpoints.add(summary, mix, checkpoint, image, reference);
  };
  ASSIGN_OR_RETURN(const FetchedRun fetched, server.fetch(job, stop, each_checkpoint));
  run.summary = fetched.summary;
  run.scheduler_cpu_seconds = fetched.scheduler_cpu_seconds;
  run.mixes.resize(fetched.summary.mixes.size());
  for (size_t m = 0; m < run.mixes.size(); ++m) run.mixes[m].checkpoints = checkpoints.of(m);
  remove_old_images(folder, before.spec.reference);
  fault.Update(write_images(folder, fetched, reference, run));
  Json json = run_json(run);
  RETURN_IF_ERROR(write_file_atomically(fs::path(folder) / "run.json", json_text(json)));
  fault.Update(write_report(folder));
  RETURN_IF_ERROR(fault);
  return json;
}

namespace {

std::string figure(const Json& value, const char* format) {
  return value.is_number() ? fmt::format(fmt::runtime(format), value.get<double>()) : "–";
}

/// "0.0123 [0.0110, 0.0140]"
std::string error_text(const Json& mix) {
  std::string text = figure(mix["relmse"], "{:.4g}");
  const Json& ci = mix["relmse_ci"];
  if (ci.is_array()) text += fmt::format(" [{}, {}]", figure(ci[0], "{:.3g}"), figure(ci[1], "{:.3g}"));
  return text;
}

}  // namespace

std::string outcome_text(const Json& run, const std::string& folder) {
  size_t width = 3;
  for (const Json& mix : run["mixes"]) width = std::max(width, mix["mix"].get<std::string>().size());
  std::string text = fmt::format("{:{}}  {:>8}  {:>9}  {:>12}  {}\n", "mix", width, "passes", "CPU s",
                                 "spent/budget", "relMSE [95 % interval]");
  for (const Json& mix : run["mixes"])
    text += fmt::format("{:{}}  {:>8}  {:>9}  {:>12}  {}\n", mix["mix"].get<std::string>(), width,
                        mix["passes"].get<int64_t>(), figure(mix["cpu_seconds"], "{:.2f}"),
                        figure(mix["budget_ratio"], "{:.3f}"), error_text(mix));
  if (run["partial"].get<bool>()) text += "interrupted: the images hold what was rendered until then\n";
  for (const Json& mix : run["mixes"])
    if (!mix["substitutions"].empty())
      for (const Json& line : mix["substitutions"])
        text += fmt::format("note: {}: {}\n", mix["mix"].get<std::string>(), line.get<std::string>());
  const fs::path base = fs::absolute(folder).lexically_normal();
  for (const Json& mix : run["mixes"])
    text += fmt::format("{}\n", (base / mix["image"].get<std::string>()).string());
  for (const char* name : {"run.json", "report.html"}) text += fmt::format("{}\n", (base / name).string());
  return text;
}

}  // namespace penumbra

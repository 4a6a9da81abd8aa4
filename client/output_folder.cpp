#include "client/output_folder.h"

#include "client/run_json.h"
#include "film/atomic_file.h"
#include "proto/status.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code none;  // what is not there is no other's file
  return fs::equivalent(a, b, none);
}

}  // namespace

absl::Status prepare_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return invalid_input("--out: {}: cannot create: {}", folder.string(), error.message());
  const fs::path trial = folder / ".penumbra-can-write";
  if (const absl::Status written = write_file_atomically(trial, ""); !written.ok())
    return invalid_input("--out: {}", message_of(written));
  fs::remove(trial, error);
  return absl::OkStatus();
}

std::string image_name(const std::string& label) {
  return file_stem(label) + ".exr";
}

absl::Status check_reference_stays(const JobSpec& spec, const fs::path& folder) {
  if (spec.reference.empty()) return absl::OkStatus();
  for (const std::string& label : labels(spec.mixes))
    if (same_file(folder / image_name(label), spec.reference))
      return invalid_input(
          "--reference: {} is where the image of {} would be written; name another folder with --out",
          spec.reference, label);
  return absl::OkStatus();
}

void remove_old_images(const fs::path& folder, const std::string& reference) {
  const absl::StatusOr<Json> old = read_json(folder / "run.json");
  if (!old.ok() || !old->is_object() || !old->contains("mixes") || !(*old)["mixes"].is_array()) return;
  for (const Json& mix : (*old)["mixes"]) {
    if (!mix.is_object() || !mix.contains("image") || !mix["image"].is_string()) continue;
    const fs::path name = mix["image"].get<std::string>();
    if (name != name.filename() || name.extension() != ".exr") continue;
    if (!reference.empty() && same_file(folder / name, reference)) continue;
    std::error_code ignored;  // gone already
    fs::remove(folder / name, ignored);
  }
}

}  // namespace penumbra

#include <cstdio>
#include <memory>

#include "client/commands.h"
#include "client/parse_text.h"
#include "client/run_json.h"
#include "film/exr.h"
#include "film/metrics.h"
#include "proto/status.h"

namespace penumbra {
namespace {

struct CompareOptions {
  std::string image, reference;
  std::vector<std::string> regions;
  bool json = false;
};

Json figures_json(const ErrorFigures& e) {
  const auto interval = e.relmse_ci ? Json::array({e.relmse_ci->low, e.relmse_ci->high}) : Json(nullptr);
  return {{"rect", to_json(e.region)},
          {"relmse", e.relmse},
          {"relmse_ci", interval},
          {"trimmed_relmse", e.trimmed_relmse},
          {"mse", e.mse},
          {"reference_floor", e.reference_floor ? Json(*e.reference_floor) : Json(nullptr)}};
}

std::string figures_text(const std::string& name, const ErrorFigures& e) {
  std::string text = fmt::format("{:12}  relMSE {:.6g}", name, e.relmse);
  if (e.relmse_ci) text += fmt::format(" [{:.4g}, {:.4g}]", e.relmse_ci->low, e.relmse_ci->high);
  text += fmt::format("  trimmed {:.6g}  MSE {:.6g}", e.trimmed_relmse, e.mse);
  if (e.reference_floor) text += fmt::format("  floor {:.3g}", *e.reference_floor);
  return text + '\n';
}

/// Means over the bins of path length, where both files have the same: {"relmse","mse","each":[relMSE…]},
/// else null.
absl::StatusOr<Json> bins_json(const CompareOptions& o) {
  const absl::StatusOr<ExrBins> bins = read_exr_bins(o.image), references = read_exr_bins(o.reference);
  if (!bins.ok() || !references.ok() || bins->transient != references->transient) return nullptr;
  Json each = Json::array();
  double relmse = 0, mse = 0;
  const auto n = static_cast<double>(bins->images.size());
  for (size_t b = 0; b < bins->images.size(); ++b) {
    ASSIGN_OR_RETURN(const ErrorFigures figures, compare(bins->images[b], references->images[b]));
    each.push_back(figures.relmse);
    relmse += figures.relmse / n;
    mse += figures.mse / n;
  }
  return Json{{"relmse", relmse}, {"mse", mse}, {"each", each}};
}

absl::StatusOr<std::string> compare_files(const CompareOptions& o) {
  ASSIGN_OR_RETURN(const FilmImage image, read_exr(o.image));
  ASSIGN_OR_RETURN(const FilmImage reference, read_exr(o.reference));
  ASSIGN_OR_RETURN(const ErrorFigures whole, compare(image, reference));
  Json json = figures_json(whole);
  std::string text = figures_text("image", whole);
  ASSIGN_OR_RETURN(json["bins"], bins_json(o));
  if (const Json& bins = json["bins"]; !bins.is_null())
    text += fmt::format("{:12}  relMSE {:.6g}  MSE {:.6g} (means over {} bins)\n", "bins",
                        bins["relmse"].get<double>(), bins["mse"].get<double>(), bins["each"].size());
  json["regions"] = Json::object();
  for (const std::string& word : o.regions) {
    ASSIGN_OR_RETURN(const Region region, parse_region("--region", word));
    const absl::StatusOr<ErrorFigures> part = compare(image, reference, region.rect);
    if (!part.ok()) return invalid_input("--region: {}: {}", region.name, message_of(part.status()));
    json["regions"][region.name] = figures_json(*part);
    text += figures_text(region.name, *part);
  }
  return o.json ? json_text(json) : text;
}

}  // namespace

void add_compare(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand("compare", "Error of an image against a reference");
  auto options = std::make_shared<CompareOptions>();
  command->add_option("image", options->image)->required()->type_name("IMAGE.exr");
  command->add_option("reference", options->reference)->required()->type_name("REFERENCE.exr");
  command->add_option("--region", options->regions, "NAME=X0,Y0,X1,Y1 in pixels, half-open; repeatable")
      ->type_name("REGION")
      ->allow_extra_args(false);
  command->add_flag("--json", options->json, "As JSON");
  command->callback([options, &chosen] {
    chosen.run = [options](std::stop_token) {
      const absl::StatusOr<std::string> text = compare_files(*options);
      if (text.ok()) fmt::print("{}", *text);
      return tell(text.status());
    };
  });
}

}  // namespace penumbra

#include "client/job_json.h"

#include <variant>

#include "client/auto_plan_json.h"
#include "client/json_integers.h"
#include "client/parse_text.h"
#include "film/film_image.h"
#include "proto/status.h"
#include "proto/tiles.h"

namespace penumbra {
namespace {

template <class... Ts>
struct Overload : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overload(Ts...) -> Overload<Ts...>;  // clang 14 does not deduce it

PixelRect rect_of(const Json& json) {
  const std::vector<int> edges = integers_of<int>(json);
  if (edges.size() != 4) throw Json::type_error::create(302, "not four edges", &json);
  return {edges[0], edges[1], edges[2], edges[3]};
}

/// May throw what nlohmann::json throws for a missing key or a wrong type.
absl::StatusOr<JobSpec> read(const Json& json) {
  JobSpec spec;
  spec.scene = json.at("scene").get<std::string>();
  spec.bundle = json.at("bundle").get<std::string>();
  for (const Json& text : json.at("mixes")) {
    ASSIGN_OR_RETURN(Mix mix, parse_mix(text.get<std::string>()));
    spec.mixes.push_back(std::move(mix));
  }
  const Json& budget = json.at("budget");
  if (budget.contains("cpu_seconds"))
    spec.budget = CpuSecondsBudget{budget["cpu_seconds"].get<double>()};
  else if (budget.contains("spp"))
    spec.budget = SppBudget{integer_of<int64_t>(budget["spp"])};
  else
    spec.budget = TargetErrorBudget{budget.at("target_error").get<double>()};
  ASSIGN_OR_RETURN(spec.sampler, parse_sampler("sampler", json.at("sampler").get<std::string>()));
  spec.width = integer_of<int>(json.at("width"));
  spec.height = integer_of<int>(json.at("height"));
  spec.crop = rect_of(json.at("crop"));
  spec.max_depth = integer_of<int>(json.at("max_depth"));
  spec.tile = integer_of<int>(json.at("tile"));
  if (json.contains("camera_grid")) spec.camera_grid = integer_of<int>(json["camera_grid"]);
  spec.seed = integer_of<uint64_t>(json.at("seed"));
  spec.strict = json.at("strict").get<bool>();
  spec.plan = integers_of<int64_t>(json.at("plan"));
  spec.reference = json.at("reference").get<std::string>();
  spec.leave_out = json.value("leave_out", std::vector<std::string>());
  for (const auto& [name, rect] : json.at("regions").items()) spec.regions.push_back({name, rect_of(rect)});
  // Edge by edge: areas and widths of any four integers may be beyond what can be said, or positive by
  // mistake.
  const PixelRect& crop = spec.crop;
  if (crop.x1 <= crop.x0 || crop.y1 <= crop.y0 || !contains({0, 0, spec.width, spec.height}, crop))
    return invalid_input("spec: the crop does not lie in {}x{}", spec.width, spec.height);
  // Absent where an earlier version wrote the file.
  if (json.contains("transient") && !json["transient"].is_null()) {
    const Json& t = json["transient"];
    spec.transient =
        Transient{t.at("t0").get<double>(), t.at("t1").get<double>(), integer_of<int>(t.at("bins"))};
  }
  // As the server will say, but before the tiles are listed here.
  if (spec.tile < 1 || spec.tile > kMostTile || tile_count(spec) > kMostTiles)
    return invalid_input("spec: tile {}", spec.tile);
  // Absent where an earlier version wrote the file: it had no `auto`.
  if (json.contains("auto_plans")) {
    ASSIGN_OR_RETURN(spec.auto_plans, auto_plans_from_json(json["auto_plans"], spec));
  }
  if (json.contains("earlier_plans")) {
    ASSIGN_OR_RETURN(spec.earlier_plans, earlier_plans_from_json(json["earlier_plans"], spec));
  }
  return spec;
}

}  // namespace

Json to_json(const PixelRect& r) {
  return Json::array({r.x0, r.y0, r.x1, r.y1});
}

Json to_json(const Budget& budget) {
  return std::visit(Overload{[](const CpuSecondsBudget& b) {
                               return Json{{"cpu_seconds", b.seconds}};
                             },
                             [](const SppBudget& b) {
                               return Json{{"spp", b.passes}};
                             },
                             [](const TargetErrorBudget& b) {
                               return Json{{"target_error", b.relmse}};
                             }},
                    budget);
}

Json to_json(const std::optional<Transient>& t) {
  return t ? Json{{"t0", t->t0}, {"t1", t->t1}, {"bins", t->bins}} : Json(nullptr);
}

Json to_json(const JobSpec& spec) {
  Json mixes = Json::array(), regions = Json::object();
  for (const Mix& mix : spec.mixes) mixes.push_back(label(mix));
  for (const Region& region : spec.regions) regions[region.name] = to_json(region.rect);
  return {{"scene", spec.scene},
          {"bundle", spec.bundle},
          {"mixes", mixes},
          {"budget", to_json(spec.budget)},
          {"sampler", name_of(spec.sampler)},
          {"width", spec.width},
          {"height", spec.height},
          {"crop", to_json(spec.crop)},
          {"max_depth", spec.max_depth},
          {"tile", spec.tile},
          {"camera_grid", spec.camera_grid},
          {"seed", spec.seed},
          {"strict", spec.strict},
          {"plan", spec.plan},
          {"auto_plans", auto_plans_json(spec, spec.auto_plans)},
          {"earlier_plans", earlier_plans_json(spec.earlier_plans)},
          {"reference", spec.reference},
          {"regions", regions},
          {"transient", to_json(spec.transient)},
          {"leave_out", spec.leave_out}};
}

absl::StatusOr<JobSpec> job_from_json(const Json& json) {
  try {
    return read(json);
  } catch (const Json::exception& fault) {
    return invalid_input("spec: {}", fault.what());
  }
}

}  // namespace penumbra

#include "client/auto_plan_json.h"

#include "client/json_integers.h"
#include "proto/auto_plan.h"
#include "proto/blocks.h"
#include "proto/status.h"
#include "proto/tiles.h"

namespace penumbra {
namespace {

/// May throw what nlohmann::json throws for a missing key or a wrong type.
absl::StatusOr<AutoPlan> read(const Json& json, const std::vector<PixelRect>& rects) {
  AutoPlan plan;
  plan.mix = integer_of<int>(json.at("mix"));
  for (const Json& text : json.at("candidates")) {
    ASSIGN_OR_RETURN(Mix mix, parse_mix(text.get<std::string>()));
    if (mix.automatic) return invalid_input("auto_plans: `auto` is no candidate of itself");
    plan.candidates.push_back(std::move(mix));
  }
  for (const Json& tile : json.at("tiles")) {
    TilePlan read{integer_of<int>(tile.at("candidate")), integer_of<int64_t>(tile.at("passes"))};
    for (const int share : tile.contains("shares") ? integers_of<int>(tile["shares"]) : std::vector<int>()) {
      if (share < 1 || share > kWholeShare) return invalid_input("auto_plans: a share of {}", share);
      read.shares.push_back(static_cast<uint8_t>(share));
    }
    if (read.candidate < 0 || read.candidate >= static_cast<int>(plan.candidates.size()))
      return invalid_input("auto_plans: candidate {} of {}", read.candidate, plan.candidates.size());
    if (read.passes < 1) return invalid_input("auto_plans: {} passes", read.passes);
    plan.tiles.push_back(std::move(read));
  }
  if (plan.tiles.size() != rects.size())
    return invalid_input("auto_plans: {} tiles, where the job has {}", plan.tiles.size(), rects.size());
  for (size_t t = 0; t < rects.size(); ++t)
    if (!shares_fit(rects[t], plan.tiles[t].shares))
      return invalid_input("auto_plans: {} shares, where the tile has {} blocks", plan.tiles[t].shares.size(),
                           block_count(rects[t]));
  return plan;
}

}  // namespace

Json auto_plans_json(const JobSpec& spec, const std::vector<AutoPlan>& plans) {
  const std::vector<PixelRect> rects = tiles_of(spec);
  Json out = Json::array();
  for (const AutoPlan& plan : plans) {
    PENUMBRA_CHECK(plan.tiles.size() == rects.size());
    Json candidates = Json::array(), tiles = Json::array();
    for (const Mix& mix : plan.candidates) candidates.push_back(label(mix));
    for (size_t t = 0; t < rects.size(); ++t) {
      tiles.push_back({{"rect", to_json(rects[t])},
                       {"candidate", plan.tiles[t].candidate},
                       {"mix", candidates[static_cast<size_t>(plan.tiles[t].candidate)]},
                       {"passes", plan.tiles[t].passes}});
      // Blocks of 8 x 8 pixels, row by row: their shares in the passes, in 1/255 (proto/blocks.h).
      if (!plan.tiles[t].shares.empty()) tiles.back()["shares"] = plan.tiles[t].shares;
    }
    out.push_back({{"mix", plan.mix}, {"candidates", candidates}, {"tiles", tiles}});
  }
  return out;
}

absl::StatusOr<std::vector<AutoPlan>> auto_plans_from_json(const Json& json, const JobSpec& spec) {
  std::vector<AutoPlan> plans;
  const std::vector<PixelRect> rects = tiles_of(spec);
  try {
    for (const Json& one : json) {
      ASSIGN_OR_RETURN(AutoPlan plan, read(one, rects));
      plans.push_back(std::move(plan));
    }
  } catch (const Json::exception& fault) {
    return invalid_input("auto_plans: {}", fault.what());
  }
  RETURN_IF_ERROR(check_auto_plans(plans, spec.mixes));
  return plans;
}

Json earlier_plans_json(const std::vector<EarlierPlan>& plans) {
  Json out = Json::array();
  for (const EarlierPlan& plan : plans)
    out.push_back({{"until", plan.until}, {"passes", plan.passes}, {"autos", plan.autos}});
  return out;
}

absl::StatusOr<std::vector<EarlierPlan>> earlier_plans_from_json(const Json& json, const JobSpec& spec) {
  std::vector<EarlierPlan> plans;
  const uint64_t tiles = tile_count(spec);
  try {
    for (const Json& one : json) {
      EarlierPlan& plan = plans.emplace_back();
      plan.until = one.at("until").get<double>();
      plan.passes = integers_of<int64_t>(one.at("passes"));
      for (const Json& tile_passes : one.at("autos")) plan.autos.push_back(integers_of<int64_t>(tile_passes));
    }
  } catch (const Json::exception& fault) {
    return invalid_input("earlier_plans: {}", fault.what());
  }
  for (const EarlierPlan& plan : plans)
    for (const std::vector<int64_t>& passes : plan.autos)
      if (passes.size() != tiles)
        return invalid_input("earlier_plans: {} tiles, where the job has {}", passes.size(), tiles);
  RETURN_IF_ERROR(check_earlier_plans(plans, spec.mixes));
  return plans;
}

}  // namespace penumbra

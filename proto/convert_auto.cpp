// What an `auto` mix is planned to be, and what stands for it in a task.
#include "proto/auto_plan.h"
#include "proto/convert.h"
#include "proto/convert_check.h"

namespace penumbra {

// More candidates than this would cost more to measure than they could save.
constexpr int kMostCandidates = 256;
// Stages are few (server/stages.h).
constexpr int kMostEarlierPlans = 16;

static absl::StatusOr<Mix> fixed_mix(std::string_view field, const std::string& text) {
  RETURN_IF_ERROR(check_text(field, text));
  ASSIGN_OR_RETURN(Mix mix, parse_mix(text));
  if (mix.automatic) return invalid_input("{}: `auto` cannot stand for itself", field);
  return mix;
}

v1::AutoPlan to_proto(const AutoPlan& plan) {
  v1::AutoPlan out;
  out.set_mix(plan.mix);
  for (const Mix& mix : plan.candidates) out.add_candidates(label(mix));
  for (const TilePlan& tile : plan.tiles) {
    v1::TilePlan* added = out.add_tiles();
    added->set_candidate(tile.candidate);
    added->set_passes(tile.passes);
    added->set_shares(tile.shares.data(), tile.shares.size());
  }
  return out;
}

absl::StatusOr<AutoPlan> from_proto(const v1::AutoPlan& message) {
  AutoPlan plan;
  plan.mix = message.mix();
  RETURN_IF_ERROR(check_range("auto_plans.candidates", message.candidates_size(), 1, kMostCandidates));
  for (const std::string& text : message.candidates()) {
    ASSIGN_OR_RETURN(Mix mix, fixed_mix("auto_plans.candidates", text));
    plan.candidates.push_back(std::move(mix));
  }
  RETURN_IF_ERROR(check_count("auto_plans.tiles", message.tiles_size()));
  for (const v1::TilePlan& tile : message.tiles()) {
    RETURN_IF_ERROR(
        check_range("auto_plans.tiles.candidate", tile.candidate(), 0, message.candidates_size() - 1));
    RETURN_IF_ERROR(check_range<int64_t>("auto_plans.tiles.passes", tile.passes(), 1, kMostPasses));
    plan.tiles.push_back({tile.candidate(), tile.passes(), {tile.shares().begin(), tile.shares().end()}});
  }
  return plan;
}

absl::StatusOr<std::vector<AutoPlan>> auto_plans_from_proto(
    const google::protobuf::RepeatedPtrField<v1::AutoPlan>& plans, const std::vector<Mix>& mixes) {
  ASSIGN_OR_RETURN(std::vector<AutoPlan> out, list_from_proto<AutoPlan>("auto_plans", plans));
  RETURN_IF_ERROR(check_auto_plans(out, mixes));
  return out;
}

v1::EarlierPlan to_proto(const EarlierPlan& plan) {
  v1::EarlierPlan out;
  out.set_until(plan.until);
  out.mutable_passes()->Add(plan.passes.begin(), plan.passes.end());
  for (const std::vector<int64_t>& tiles : plan.autos)
    out.add_autos()->mutable_passes()->Add(tiles.begin(), tiles.end());
  return out;
}

absl::StatusOr<std::vector<EarlierPlan>> earlier_plans_from_proto(
    const google::protobuf::RepeatedPtrField<v1::EarlierPlan>& plans, const std::vector<Mix>& mixes) {
  RETURN_IF_ERROR(check_range("earlier_plans", plans.size(), 0, kMostEarlierPlans));
  std::vector<EarlierPlan> out;
  for (const v1::EarlierPlan& message : plans) {
    EarlierPlan plan;
    plan.until = message.until();
    ASSIGN_OR_RETURN(plan.passes, passes_from_proto("earlier_plans.passes", message.passes()));
    for (const v1::EarlierPlan::TilePasses& tiles : message.autos()) {
      ASSIGN_OR_RETURN(std::vector<int64_t> passes, passes_from_proto("earlier_plans.autos", tiles.passes()));
      plan.autos.push_back(std::move(passes));
    }
    out.push_back(std::move(plan));
  }
  RETURN_IF_ERROR(check_earlier_plans(out, mixes));
  return out;
}

v1::ChosenMix to_proto(const ChosenMix& chosen) {
  v1::ChosenMix out;
  out.set_mix(chosen.mix);
  out.set_chosen(label(chosen.chosen));
  out.set_group(chosen.group);
  out.set_shares(chosen.shares.data(), chosen.shares.size());
  return out;
}

absl::StatusOr<ChosenMix> from_proto(const v1::ChosenMix& message) {
  ChosenMix chosen;
  chosen.mix = message.mix();
  ASSIGN_OR_RETURN(chosen.chosen, fixed_mix("chosen", message.chosen()));
  RETURN_IF_ERROR(check_range<int64_t>("chosen.group", message.group(), 1, kMostPasses));
  chosen.group = message.group();
  chosen.shares.assign(message.shares().begin(), message.shares().end());
  return chosen;
}

}  // namespace penumbra

#include "proto/convert.h"

#include <set>

#include "proto/blob_folder.h"
#include "proto/blocks.h"
#include "proto/convert_check.h"

namespace penumbra {

constexpr int kMostEdge = 65536;
constexpr int kMostMixes = 256;
constexpr int kMostRegions = 4096;

static v1::SamplerKind to_proto(SamplerKind kind) {
  switch (kind) {
    case SamplerKind::kIndependent:
      return v1::SAMPLER_KIND_INDEPENDENT;
    case SamplerKind::kStratified:
      return v1::SAMPLER_KIND_STRATIFIED;
    case SamplerKind::kSobol:
      return v1::SAMPLER_KIND_SOBOL;
  }
  std::abort();
}

static absl::StatusOr<SamplerKind> from_proto(v1::SamplerKind kind) {
  switch (kind) {
    case v1::SAMPLER_KIND_INDEPENDENT:
      return SamplerKind::kIndependent;
    case v1::SAMPLER_KIND_STRATIFIED:
      return SamplerKind::kStratified;
    case v1::SAMPLER_KIND_SOBOL:
      return SamplerKind::kSobol;
    default:
      return invalid_input("sampler: unknown value {}", static_cast<int>(kind));
  }
}

static v1::Budget to_proto(const Budget& budget) {
  v1::Budget out;
  if (const auto* cpu = std::get_if<CpuSecondsBudget>(&budget)) out.set_cpu_seconds(cpu->seconds);
  if (const auto* spp = std::get_if<SppBudget>(&budget)) out.set_spp(spp->passes);
  if (const auto* error = std::get_if<TargetErrorBudget>(&budget)) out.set_target_error(error->relmse);
  return out;
}

/// A microsecond to some 30,000 years: what is planned for so many seconds, and ratios to them, stay finite.
static constexpr double kLeastSeconds = 1e-6, kMostSeconds = 1e12;
/// Its square and its inverse are numbers, too.
static constexpr double kLeastError = 1e-30, kMostError = 1e30;

static absl::Status check_within(std::string_view field, double value, double least, double most) {
  if (!(value >= least && value <= most))
    return invalid_input("{}: {} is not a number from {} to {}", field, value, least, most);
  return absl::OkStatus();
}

static absl::StatusOr<Budget> from_proto(const v1::Budget& budget) {
  switch (budget.kind_case()) {
    case v1::Budget::kCpuSeconds:
      RETURN_IF_ERROR(check_within("budget.cpu_seconds", budget.cpu_seconds(), kLeastSeconds, kMostSeconds));
      return CpuSecondsBudget{budget.cpu_seconds()};
    case v1::Budget::kSpp:
      RETURN_IF_ERROR(check_range<int64_t>("budget.spp", budget.spp(), 1, kMostPasses));
      return SppBudget{budget.spp()};
    case v1::Budget::kTargetError:
      RETURN_IF_ERROR(check_within("budget.target_error", budget.target_error(), kLeastError, kMostError));
      return TargetErrorBudget{budget.target_error()};
    default:
      return invalid_input("budget: none is set");
  }
}

static absl::StatusOr<std::vector<Mix>> mixes_from_proto(const v1::JobSpec& spec) {
  RETURN_IF_ERROR(check_range("mixes", spec.mixes_size(), 1, kMostMixes));
  std::vector<Mix> mixes;
  for (const std::string& text : spec.mixes()) {
    RETURN_IF_ERROR(check_text("mixes", text));
    ASSIGN_OR_RETURN(Mix mix, parse_mix(text));
    mixes.push_back(std::move(mix));
  }
  return mixes;
}

static absl::StatusOr<std::vector<Region>> regions_from_proto(const v1::JobSpec& spec) {
  RETURN_IF_ERROR(check_range("regions", spec.regions_size(), 0, kMostRegions));
  std::vector<Region> regions;
  for (const v1::Region& region : spec.regions()) {
    RETURN_IF_ERROR(check_text("regions.name", region.name()));
    ASSIGN_OR_RETURN(const PixelRect rect, from_proto(region.rect()));
    regions.push_back({region.name(), rect});
  }
  return regions;
}

/// Edges and counts that must agree with each other.
// There are fewer than that.
constexpr int kMostLeftOut = 32;

static absl::Status check_spec(const JobSpec& spec) {
  RETURN_IF_ERROR(check_range("width", spec.width, 1, kMostEdge));
  RETURN_IF_ERROR(check_range("height", spec.height, 1, kMostEdge));
  RETURN_IF_ERROR(check_range("tile", spec.tile, 1, kMostTile));
  RETURN_IF_ERROR(check_range("max_depth", spec.max_depth, 1, kMostDepth));
  RETURN_IF_ERROR(check_range("camera_grid", spec.camera_grid, 0, kMostCameraGrid));
  if (const std::string fault = fault_of_bins(spec); !fault.empty())
    return invalid_input("transient: {}", fault);
  if (spec.crop.area() == 0 || spec.crop.x1 > spec.width || spec.crop.y1 > spec.height)
    return invalid_input("crop: empty, or not inside the image");
  if (!spec.plan.empty() && spec.plan.size() != spec.mixes.size())
    return invalid_input("plan: {} counts for {} mixes", spec.plan.size(), spec.mixes.size());
  if (!is_digest(spec.bundle)) return invalid_input("bundle: '{:.80}' is not a digest", spec.bundle);
  return absl::OkStatus();
}

v1::PixelRect to_proto(const PixelRect& rect) {
  v1::PixelRect out;
  out.set_x0(rect.x0);
  out.set_y0(rect.y0);
  out.set_x1(rect.x1);
  out.set_y1(rect.y1);
  return out;
}

absl::StatusOr<PixelRect> from_proto(const v1::PixelRect& rect) {
  for (const int edge : {rect.x0(), rect.y0(), rect.x1(), rect.y1()})
    RETURN_IF_ERROR(check_range("rect", edge, 0, kMostEdge));
  if (rect.x1() < rect.x0() || rect.y1() < rect.y0())
    return invalid_input("rect: [{},{})x[{},{}) is inside out", rect.x0(), rect.x1(), rect.y0(), rect.y1());
  return PixelRect{rect.x0(), rect.y0(), rect.x1(), rect.y1()};
}

v1::Probe to_proto(const Probe& probe) {
  v1::Probe out;
  out.set_kind(probe.kind == Probe::Kind::kVariance ? v1::Probe::KIND_VARIANCE : v1::Probe::KIND_INTEGRAND);
  out.set_camera_width(probe.camera_width);
  out.set_camera_height(probe.camera_height);
  out.set_x(probe.x);
  out.set_y(probe.y);
  out.set_light(probe.light);
  out.mutable_slots()->Add(probe.slots.begin(), probe.slots.end());
  return out;
}

absl::StatusOr<Probe> from_proto(const v1::Probe& message) {
  Probe probe;
  if (message.kind() == v1::Probe::KIND_VARIANCE) return probe;
  if (message.kind() != v1::Probe::KIND_INTEGRAND)
    return invalid_input("probe.kind: unknown value {}", static_cast<int>(message.kind()));
  probe.kind = Probe::Kind::kIntegrand;
  RETURN_IF_ERROR(check_range("probe.camera_width", message.camera_width(), 1, kMostEdge));
  RETURN_IF_ERROR(check_range("probe.camera_height", message.camera_height(), 1, kMostEdge));
  RETURN_IF_ERROR(check_range("probe.x", message.x(), 0, message.camera_width() - 1));
  RETURN_IF_ERROR(check_range("probe.y", message.y(), 0, message.camera_height() - 1));
  RETURN_IF_ERROR(check_range("probe.light", message.light(), 0, std::numeric_limits<int>::max()));
  RETURN_IF_ERROR(check_range("probe.slots", message.slots_size(), 1, kMostMixes));
  probe.camera_width = message.camera_width();
  probe.camera_height = message.camera_height();
  probe.x = message.x();
  probe.y = message.y();
  probe.light = message.light();
  for (const int slot : message.slots()) {
    RETURN_IF_ERROR(check_range("probe.slots", slot, 0, kMostMixes - 1));
    probe.slots.push_back(slot);
  }
  return probe;
}

v1::JobSpec to_proto(const JobSpec& spec) {
  v1::JobSpec out;
  out.set_scene(spec.scene);
  out.set_bundle(spec.bundle);
  for (const Mix& mix : spec.mixes) out.add_mixes(label(mix));
  *out.mutable_budget() = to_proto(spec.budget);
  out.set_sampler(to_proto(spec.sampler));
  out.set_width(spec.width);
  out.set_height(spec.height);
  *out.mutable_crop() = to_proto(spec.crop);
  out.set_max_depth(spec.max_depth);
  out.set_tile(spec.tile);
  out.set_camera_grid(spec.camera_grid);
  out.set_seed(spec.seed);
  out.set_strict(spec.strict);
  out.mutable_plan()->Add(spec.plan.begin(), spec.plan.end());
  for (const AutoPlan& plan : spec.auto_plans) *out.add_auto_plans() = to_proto(plan);
  for (const EarlierPlan& plan : spec.earlier_plans) *out.add_earlier_plans() = to_proto(plan);
  out.set_reference(spec.reference);
  for (const Region& region : spec.regions) {
    v1::Region* added = out.add_regions();
    added->set_name(region.name);
    *added->mutable_rect() = to_proto(region.rect);
  }
  if (spec.probe) *out.mutable_probe() = to_proto(*spec.probe);
  for (const std::string& effect : spec.leave_out) out.add_leave_out(effect);
  if (spec.transient) {
    out.mutable_transient()->set_t0(spec.transient->t0);
    out.mutable_transient()->set_t1(spec.transient->t1);
    out.mutable_transient()->set_bins(spec.transient->bins);
  }
  return out;
}

absl::StatusOr<JobSpec> from_proto(const v1::JobSpec& message) {
  JobSpec spec;
  RETURN_IF_ERROR(check_text("scene", message.scene(), kMostPath));
  RETURN_IF_ERROR(check_text("reference", message.reference(), kMostPath));
  spec.scene = message.scene();
  spec.bundle = message.bundle();
  ASSIGN_OR_RETURN(spec.mixes, mixes_from_proto(message));
  ASSIGN_OR_RETURN(spec.budget, from_proto(message.budget()));
  ASSIGN_OR_RETURN(spec.sampler, from_proto(message.sampler()));
  spec.width = message.width();
  spec.height = message.height();
  ASSIGN_OR_RETURN(spec.crop, from_proto(message.crop()));
  spec.max_depth = message.max_depth();
  spec.tile = message.tile();
  spec.camera_grid = message.camera_grid();
  spec.seed = message.seed();
  spec.strict = message.strict();
  ASSIGN_OR_RETURN(spec.plan, passes_from_proto("plan", message.plan()));
  ASSIGN_OR_RETURN(spec.auto_plans, auto_plans_from_proto(message.auto_plans(), spec.mixes));
  if (spec.plan.empty() != spec.auto_plans.empty() && !automatic_mixes(spec.mixes).empty())
    return invalid_input("plan: passes and the plans of `auto` belong together");
  ASSIGN_OR_RETURN(spec.earlier_plans, earlier_plans_from_proto(message.earlier_plans(), spec.mixes));
  if (spec.plan.empty() && !spec.earlier_plans.empty())
    return invalid_input("earlier_plans: there is no plan that they were before");
  spec.reference = message.reference();
  ASSIGN_OR_RETURN(spec.regions, regions_from_proto(message));
  if (message.has_probe()) {
    ASSIGN_OR_RETURN(spec.probe, from_proto(message.probe()));
    if (spec.probe->kind == Probe::Kind::kIntegrand && spec.probe->slots.size() != spec.mixes.size())
      return invalid_input("probe.slots: {} for {} mixes", spec.probe->slots.size(), spec.mixes.size());
  }
  if (message.leave_out_size() > kMostLeftOut)
    return invalid_input("leave_out: {} effects, at most {}", message.leave_out_size(), kMostLeftOut);
  for (const std::string& effect : message.leave_out()) {
    RETURN_IF_ERROR(check_text("leave_out", effect));
    spec.leave_out.push_back(effect);
  }
  if (message.has_transient())
    spec.transient =
        Transient{message.transient().t0(), message.transient().t1(), message.transient().bins()};
  RETURN_IF_ERROR(check_spec(spec));
  return spec;
}

static v1::PassRange to_proto(const PassRange& range) {
  v1::PassRange out;
  out.set_begin(range.begin);
  out.set_end(range.end);
  return out;
}

static absl::StatusOr<PassRange> from_proto(const v1::PassRange& message) {
  RETURN_IF_ERROR(check_range<int64_t>("passes.begin", message.begin(), 0, kMostPasses));
  RETURN_IF_ERROR(check_range<int64_t>("passes.end", message.end(), message.begin(), kMostPasses));
  return PassRange{message.begin(), message.end()};
}

v1::TileTask to_proto(const TileTask& task) {
  v1::TileTask out;
  out.set_id(task.id);
  out.set_kind(task.kind == TaskKind::kPilot ? v1::TASK_KIND_PILOT : v1::TASK_KIND_RUN);
  *out.mutable_tile() = to_proto(task.tile);
  for (const PassRange& range : task.passes) *out.add_passes() = to_proto(range);
  out.set_group(task.group);
  out.set_shuffle(task.shuffle);
  out.set_pilot_seconds(task.pilot_seconds);
  for (const ChosenMix& chosen : task.chosen) *out.add_chosen() = to_proto(chosen);
  out.set_pilot_blocks(task.pilot_blocks);
  for (const PassRange& range : task.repilot) *out.add_repilot() = to_proto(range);
  return out;
}

absl::StatusOr<TileTask> from_proto(const v1::TileTask& message) {
  TileTask task;
  task.id = message.id();
  if (message.kind() != v1::TASK_KIND_PILOT && message.kind() != v1::TASK_KIND_RUN)
    return invalid_input("kind: unknown value {}", static_cast<int>(message.kind()));
  task.kind = message.kind() == v1::TASK_KIND_PILOT ? TaskKind::kPilot : TaskKind::kRun;
  ASSIGN_OR_RETURN(task.tile, from_proto(message.tile()));
  if (task.tile.area() == 0) return invalid_input("tile: empty");
  RETURN_IF_ERROR(check_range("passes", message.passes_size(), 1, kMostMixes));
  for (const v1::PassRange& range : message.passes()) {
    ASSIGN_OR_RETURN(const PassRange converted, from_proto(range));
    task.passes.push_back(converted);
  }
  RETURN_IF_ERROR(check_range<int64_t>("group", message.group(), 1, kMostPasses));
  task.group = message.group();
  task.shuffle = message.shuffle();
  RETURN_IF_ERROR(check_amount("pilot_seconds", message.pilot_seconds()));
  task.pilot_seconds = message.pilot_seconds();
  ASSIGN_OR_RETURN(task.chosen, list_from_proto<ChosenMix>("chosen", message.chosen()));
  for (const ChosenMix& chosen : task.chosen) {
    RETURN_IF_ERROR(check_range("chosen.mix", chosen.mix, 0, message.passes_size() - 1));
    if (!shares_fit(task.tile, chosen.shares))
      return invalid_input("chosen.shares: {} for {} blocks, or one is 0", chosen.shares.size(),
                           block_count(task.tile));
  }
  RETURN_IF_ERROR(check_range("pilot_blocks", message.pilot_blocks(), 0, kMostTile * kMostTile));
  task.pilot_blocks = message.pilot_blocks();
  for (const v1::PassRange& range : message.repilot()) {
    ASSIGN_OR_RETURN(const PassRange converted, from_proto(range));
    task.repilot.push_back(converted);
  }
  if (!task.repilot.empty() && task.repilot.size() != task.passes.size())
    return invalid_input("repilot: {} ranges for {} mixes", task.repilot.size(), task.passes.size());
  return task;
}

}  // namespace penumbra

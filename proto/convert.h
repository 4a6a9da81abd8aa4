#pragma once
// The one seam between the wire's messages and the domain's structs. to_proto never fails; from_proto
// checks every range and returns InvalidArgument with the name of the field at fault, so that nothing
// behind it needs to distrust what it gets. from_proto(to_proto(x)) == x.
#include "absl/status/statusor.h"
#include "proto/auto_plan.h"
#include "proto/job.h"
#include "proto/job.pb.h"
#include "proto/render.pb.h"
#include "proto/run.h"
#include "proto/sync.h"
#include "proto/worker.pb.h"

namespace penumbra {

v1::PixelRect to_proto(const PixelRect& rect);
v1::Probe to_proto(const Probe& probe);
v1::JobSpec to_proto(const JobSpec& spec);
v1::AutoPlan to_proto(const AutoPlan& plan);
v1::ChosenMix to_proto(const ChosenMix& chosen);
v1::TileTask to_proto(const TileTask& task);
v1::Calibration to_proto(const Calibration& calibration);
v1::MixCost to_proto(const MixCost& cost);
v1::LoadReport to_proto(const LoadReport& report);
v1::WorkerInfo to_proto(const WorkerInfo& worker);
v1::JobTerms to_proto(const JobTerms& terms);
v1::LogResponse::Line to_proto(const LogLine& line);
v1::JobStatus to_proto(const JobStatus& status);
v1::MixSummary to_proto(const MixSummary& mix);
v1::TileRow to_proto(const TileRow& row);
v1::RunSummary to_proto(const RunSummary& summary);
v1::LeaseId to_proto(const LeaseId& lease);
v1::SyncRequest::Loaded to_proto(const LoadedScene& scene);
v1::SyncRequest to_proto(const WorkerState& state);
v1::SyncResponse to_proto(const DesiredState& state);

absl::StatusOr<PixelRect> from_proto(const v1::PixelRect& rect);
absl::StatusOr<Probe> from_proto(const v1::Probe& probe);
absl::StatusOr<JobSpec> from_proto(const v1::JobSpec& spec);
absl::StatusOr<AutoPlan> from_proto(const v1::AutoPlan& plan);
/// All plans of a job with these mixes: none, or one for each `auto`.
v1::EarlierPlan to_proto(const EarlierPlan& plan);
/// Counts per mix must fit; whether counts per tile do is known only with the tiles.
absl::StatusOr<std::vector<EarlierPlan>> earlier_plans_from_proto(
    const google::protobuf::RepeatedPtrField<v1::EarlierPlan>& plans, const std::vector<Mix>& mixes);
absl::StatusOr<std::vector<AutoPlan>> auto_plans_from_proto(
    const google::protobuf::RepeatedPtrField<v1::AutoPlan>& plans, const std::vector<Mix>& mixes);
absl::StatusOr<ChosenMix> from_proto(const v1::ChosenMix& chosen);
absl::StatusOr<TileTask> from_proto(const v1::TileTask& task);
absl::StatusOr<Calibration> from_proto(const v1::Calibration& calibration);
absl::StatusOr<MixCost> from_proto(const v1::MixCost& cost);
absl::StatusOr<LoadReport> from_proto(const v1::LoadReport& report);
absl::StatusOr<WorkerInfo> from_proto(const v1::WorkerInfo& worker);
absl::StatusOr<JobTerms> from_proto(const v1::JobTerms& terms);
absl::StatusOr<LogLine> from_proto(const v1::LogResponse::Line& line);
absl::StatusOr<JobStatus> from_proto(const v1::JobStatus& status);
absl::StatusOr<MixSummary> from_proto(const v1::MixSummary& mix);
absl::StatusOr<TileRow> from_proto(const v1::TileRow& row);
absl::StatusOr<RunSummary> from_proto(const v1::RunSummary& summary);
absl::StatusOr<LeaseId> from_proto(const v1::LeaseId& lease);
absl::StatusOr<HeldLease> from_proto(const v1::SyncRequest::Held& held);
absl::StatusOr<CompletedTask> from_proto(const v1::SyncRequest::Completed& task);
absl::StatusOr<FailedTask> from_proto(const v1::SyncRequest::Failed& task);
absl::StatusOr<LoadedScene> from_proto(const v1::SyncRequest::Loaded& scene);
/// FailedPrecondition if the protocol version is not ours.
absl::StatusOr<WorkerState> from_proto(const v1::SyncRequest& request);
absl::StatusOr<DesiredState> from_proto(const v1::SyncResponse& response);

}  // namespace penumbra

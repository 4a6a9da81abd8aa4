#include "server/stored_job.h"

#include "proto/convert.h"
#include "proto/status.h"
#include "proto/store.pb.h"

namespace penumbra {
namespace {

template <class Message>
absl::StatusOr<Message> parse(std::string_view bytes, std::string_view what) {
  Message message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    return make_status(absl::StatusCode::kDataLoss, "job store: a {} cannot be read", what);
  return message;
}

}  // namespace

std::string serialize_header(const JobHeader& header) {
  v1::StoredJob out;
  out.set_id(header.id);
  out.set_request_id(header.request_id);
  *out.mutable_spec() = to_proto(header.spec);
  JobStatus status;
  status.state = header.state;
  status.failure = header.failure;
  status.message = header.message;
  status.plan = header.passes;
  status.submitted_unix_seconds = header.submitted_unix;
  status.faults = header.faults;
  status.terms = header.terms;
  *out.mutable_status() = to_proto(status);
  if (header.loaded) *out.mutable_loaded() = to_proto({header.id, header.load, header.substitutions});
  out.set_first_lease_unix(header.first_lease_unix);
  out.set_first_result_unix(header.first_result_unix);
  out.set_last_result_unix(header.last_result_unix);
  out.set_finished_unix(header.finished_unix);
  out.set_worker_cpu_seconds(header.worker_cpu_seconds);
  out.set_scheduler_cpu_seconds(header.scheduler_cpu_seconds);
  for (const AutoPlan& plan : header.auto_plans) *out.add_auto_plans() = to_proto(plan);
  for (const EarlierPlan& plan : header.earlier_plans) *out.add_earlier_plans() = to_proto(plan);
  out.mutable_open_borders()->Add(header.open_borders.begin(), header.open_borders.end());
  return out.SerializeAsString();
}

absl::StatusOr<JobHeader> parse_header(std::string_view bytes) {
  ASSIGN_OR_RETURN(const v1::StoredJob message, parse<v1::StoredJob>(bytes, "job"));
  JobHeader header;
  header.id = message.id();
  header.request_id = message.request_id();
  ASSIGN_OR_RETURN(header.spec, from_proto(message.spec()));
  ASSIGN_OR_RETURN(JobStatus status, from_proto(message.status()));
  header.state = status.state;
  header.failure = status.failure;
  header.message = std::move(status.message);
  header.passes = std::move(status.plan);
  header.submitted_unix = status.submitted_unix_seconds;
  header.faults = status.faults;
  header.terms = std::move(status.terms);
  header.loaded = message.has_loaded();
  if (header.loaded) {
    ASSIGN_OR_RETURN(LoadedScene scene, from_proto(message.loaded()));
    header.load = std::move(scene.report);
    header.substitutions = std::move(scene.substitutions);
  }
  header.first_lease_unix = message.first_lease_unix();
  header.first_result_unix = message.first_result_unix();
  header.last_result_unix = message.last_result_unix();
  header.finished_unix = message.finished_unix();
  header.worker_cpu_seconds = message.worker_cpu_seconds();
  header.scheduler_cpu_seconds = message.scheduler_cpu_seconds();
  ASSIGN_OR_RETURN(header.auto_plans, auto_plans_from_proto(message.auto_plans(), header.spec.mixes));
  ASSIGN_OR_RETURN(header.earlier_plans,
                   earlier_plans_from_proto(message.earlier_plans(), header.spec.mixes));
  header.open_borders.assign(message.open_borders().begin(), message.open_borders().end());
  return header;
}

std::string serialize_costs(const std::vector<MixCost>& costs) {
  v1::StoredCosts out;
  for (const MixCost& cost : costs) *out.add_costs() = to_proto(cost);
  return out.SerializeAsString();
}

absl::StatusOr<std::vector<MixCost>> parse_costs(std::string_view bytes) {
  ASSIGN_OR_RETURN(const v1::StoredCosts message, parse<v1::StoredCosts>(bytes, "result's costs"));
  std::vector<MixCost> costs;
  for (const v1::MixCost& cost : message.costs()) {
    ASSIGN_OR_RETURN(const MixCost converted, from_proto(cost));
    costs.push_back(converted);
  }
  return costs;
}

std::string serialize_worker(const WorkerInfo& worker) {
  return to_proto(worker).SerializeAsString();
}

absl::StatusOr<WorkerInfo> parse_worker(std::string_view bytes) {
  ASSIGN_OR_RETURN(const v1::WorkerInfo message, parse<v1::WorkerInfo>(bytes, "worker"));
  return from_proto(message);
}

}  // namespace penumbra

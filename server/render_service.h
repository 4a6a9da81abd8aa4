#pragma once
#include "proto/render.grpc.pb.h"
#include "server/assembler.h"
#include "server/coordinator.h"

namespace penumbra {

/// proto/render.proto over the coordinator. Translates only.
class RenderService final : public v1::Render::Service {
 public:
  explicit RenderService(Coordinator& coordinator) : coordinator_(coordinator) {}

  grpc::Status Submit(grpc::ServerContext* context, const v1::SubmitRequest* request,
                      v1::SubmitResponse* response) override;
  grpc::Status GetJob(grpc::ServerContext*, const v1::JobRequest* request, v1::JobStatus* response) override;
  grpc::Status Watch(grpc::ServerContext* context, const v1::JobRequest* request,
                     grpc::ServerWriter<v1::JobStatus>* writer) override;
  grpc::Status ListJobs(grpc::ServerContext*, const v1::ListJobsRequest* request,
                        v1::ListJobsResponse* response) override;
  grpc::Status Cancel(grpc::ServerContext* context, const v1::JobRequest* request,
                      v1::JobStatus* response) override;
  grpc::Status Explain(grpc::ServerContext*, const v1::JobRequest* request,
                       v1::ExplainResponse* response) override;
  grpc::Status Log(grpc::ServerContext*, const v1::LogRequest* request, v1::LogResponse* response) override;
  grpc::Status FetchFrames(grpc::ServerContext* context, const v1::FetchFramesRequest* request,
                           grpc::ServerWriter<v1::FetchFramesResponse>* writer) override;

 private:
  absl::StatusOr<JobStatus> status(const JobId& id);

  absl::Status restore_lost(const JobId& id, const Assembly& assembly, const grpc::ServerContext& context);

  Coordinator& coordinator_;
};

}  // namespace penumbra

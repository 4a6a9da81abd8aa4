#include "proto/rpc_status.h"

namespace penumbra {

grpc::Status to_grpc(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), message_of(status));
}

absl::Status from_grpc(const grpc::Status& status) {
  if (status.ok()) return absl::OkStatus();
  return absl::Status(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
}

bool is_overload(const absl::Status& status) {
  // Nothing but the words tells it from what our services exhaust.
  return absl::IsResourceExhausted(status) && status.message().find("Threadpool") != std::string_view::npos;
}

}  // namespace penumbra

#pragma once
// absl::Status <-> grpc::Status: the same sixteen codes under two names.
#include <grpcpp/support/status.h>

#include "proto/status.h"

namespace penumbra {

grpc::Status to_grpc(const absl::Status& status);
absl::Status from_grpc(const grpc::Status& status);

/// gRPC's own answer in place of a server that has a caller for each of its threads: worth another try.
bool is_overload(const absl::Status& status);

}  // namespace penumbra

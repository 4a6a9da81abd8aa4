#pragma once
// absl::Status <-> grpc::Status: the same sixteen codes under two names.
#include <grpcpp/support/status.h>

#include "proto/status.h"

namespace penumbra {

grpc::Status to_grpc(const absl::Status& status);
absl::Status from_grpc(const grpc::Status& status);

}  // namespace penumbra

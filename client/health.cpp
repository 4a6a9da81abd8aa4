#include <grpcpp/generic/generic_stub.h>

#include <chrono>
#include <future>
#include <memory>

#include "client/commands.h"
#include "client/exit_code.h"
#include "client/options.h"
#include "proto/channel.h"
#include "proto/rpc_status.h"
#include "proto/status.h"

namespace penumbra {
namespace {

/// grpc.health.v1.Health/Check of the server as a whole. Debian packages no stub for it; the request is the
/// empty message, the answer's field 1 a varint, 1 for SERVING (grpc/health/v1/health.proto).
absl::Status check(const ServerOptions& options) {
  ASSIGN_OR_RETURN(const std::shared_ptr<grpc::Channel> channel,
                   open_channel(options.address, options.credentials));
  constexpr std::chrono::seconds kDeadline{5};
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kDeadline);
  grpc::GenericStub stub(channel);
  const grpc::Slice empty(nullptr, 0);
  const grpc::ByteBuffer request(&empty, 1);
  grpc::ByteBuffer response;
  std::promise<grpc::Status> answered;
  stub.UnaryCall(&context, "/grpc.health.v1.Health/Check", {}, &request, &response,
                 [&](grpc::Status status) { answered.set_value(std::move(status)); });
  RETURN_IF_ERROR(from_grpc(answered.get_future().get()));
  grpc::Slice bytes;
  if (!response.DumpToSingleSlice(&bytes).ok() || bytes.size() != 2 || bytes.begin()[0] != (1 << 3) ||
      bytes.begin()[1] != 1)
    return make_status(absl::StatusCode::kFailedPrecondition, "server {} is not serving", options.address);
  return absl::OkStatus();
}

}  // namespace

void add_health(CLI::App& app, Chosen& chosen) {
  CLI::App* command = app.add_subcommand(
      "health", "Whether a server serves (grpc.health.v1), for probes: 0, or 1, or 5 if unreachable");
  auto options = std::make_shared<ServerOptions>();
  add_server_options(*command, *options, true);
  command->callback(
      [options, &chosen] { chosen.run = [options](std::stop_token) { return tell(check(*options)); }; });
}

}  // namespace penumbra

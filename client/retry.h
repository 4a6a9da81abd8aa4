#pragma once
// One way to wait for a server that does not answer.
#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "proto/rpc_status.h"
#include "proto/status.h"

namespace penumbra {

/// How long and how often to try again. The clock starts with the first failure after a success.
struct RetryPolicy {
  std::chrono::milliseconds patience{10'000};
  std::chrono::milliseconds first_pause{50};
  std::chrono::milliseconds longest_pause{1'000};
};

class Retry {
 public:
  using Clock = std::chrono::steady_clock;
  Retry(std::string address, std::function<absl::Status()> check, std::stop_token stop,
        RetryPolicy policy = {})
      : address_(std::move(address)), check_(std::move(check)), stop_(std::move(stop)), policy_(policy) {}

  /// The server has answered: patience begins anew.
  void answered() {
    first_failure_.reset();
    pause_ = policy_.first_pause;
  }

  /// After a failed call: OK means try again (it has paused); an error is the call's outcome.
  absl::Status after(const absl::Status& failure) {
    if (stop_.stop_requested()) return absl::CancelledError("interrupted");
    if (!absl::IsUnavailable(failure) && !absl::IsDeadlineExceeded(failure) && !is_overload(failure))
      return failure;
    if (check_) RETURN_IF_ERROR(check_());
    const auto now = Clock::now();
    if (!first_failure_) first_failure_ = now;
    if (now - *first_failure_ >= policy_.patience)
      return make_status(absl::StatusCode::kUnavailable, "server {} is unreachable: {}", address_,
                         message_of(failure));
    pause();
    return stop_.stop_requested() ? absl::CancelledError("interrupted") : absl::OkStatus();
  }

 private:
  void pause() {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any().wait_for(lock, stop_, pause_, [] { return false; });
    pause_ = std::min(2 * pause_, policy_.longest_pause);
  }

  std::string address_;
  std::function<absl::Status()> check_;
  std::stop_token stop_;
  RetryPolicy policy_;
  std::optional<Clock::time_point> first_failure_;
  std::chrono::milliseconds pause_ = policy_.first_pause;
};

/// Makes a call until it succeeds, fails for good, or patience ends. `call(context)` returns grpc::Status;
/// a stopped token cancels it. `deadline` bounds one attempt of a unary call; zero: none (streams).
template <class Call>
absl::Status call_with_retries(Retry retry, std::stop_token stop, std::chrono::seconds deadline,
                               Call&& call) {
  for (;;) {
    grpc::ClientContext context;
    if (deadline.count() > 0) context.set_deadline(std::chrono::system_clock::now() + deadline);
    const std::stop_callback cancel(stop, [&] { context.TryCancel(); });
    const absl::Status status = from_grpc(call(context, retry));
    if (status.ok()) return status;
    RETURN_IF_ERROR(retry.after(status));
  }
}

}  // namespace penumbra

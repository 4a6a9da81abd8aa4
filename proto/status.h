#pragma once
// Errors as values: absl::Status with {fmt} messages. A user's fault is InvalidArgument (exit code 2) and
// its message names file:line:column or the flag; a programmer's fault is PENUMBRA_CHECK.
// (Debian's abseil has a string_view of its own; the conversions between it and std's live here.)
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace penumbra {

template <class... Args>
absl::Status invalid_input(fmt::format_string<Args...> text, Args&&... args) {
  return absl::InvalidArgumentError(fmt::format(text, std::forward<Args>(args)...));
}

template <class... Args>
absl::Status make_status(absl::StatusCode code, fmt::format_string<Args...> text, Args&&... args) {
  return absl::Status(code, fmt::format(text, std::forward<Args>(args)...));
}

inline std::string message_of(const absl::Status& status) {
  return std::string(status.message().data(), status.message().size());
}

}  // namespace penumbra

#define PENUMBRA_CONCAT_(a, b) a##b
#define PENUMBRA_CONCAT(a, b) PENUMBRA_CONCAT_(a, b)

/// Returns from the calling function if the expression is an error.
#define RETURN_IF_ERROR(expression)                                     \
  do {                                                                  \
    if (absl::Status status_ = (expression); !status_.ok()) return status_; \
  } while (false)

/// ASSIGN_OR_RETURN(auto value, maybe()): the value, or returns the error.
#define ASSIGN_OR_RETURN(declaration, expression) \
  ASSIGN_OR_RETURN_(PENUMBRA_CONCAT(statusor_, __LINE__), declaration, expression)
#define ASSIGN_OR_RETURN_(temporary, declaration, expression) \
  auto temporary = (expression);                              \
  if (!temporary.ok()) return temporary.status();             \
  declaration = *std::move(temporary)

/// A programmer's fault: says what and where, and aborts.
#define PENUMBRA_CHECK(condition)                                                              \
  do {                                                                                         \
    if (!(condition)) {                                                                        \
      std::fprintf(stderr, "%s:%d: check failed: %s\n", __FILE__, __LINE__, #condition);       \
      std::abort();                                                                            \
    }                                                                                          \
  } while (false)

#include <cstdio>

#include "client/commands.h"
#include "client/exit_code.h"
#include "proto/status.h"

namespace penumbra {

int tell(const absl::Status& status) {
  if (!status.ok()) fmt::print(stderr, "penumbra: {}\n", message_of(status));
  return exit_code(status);
}

}  // namespace penumbra

#pragma once
#include <memory>
#include <string>

#include "server/job_store.h"

namespace penumbra {

/// SQLite in WAL mode with synchronous=FULL: a transaction that has returned survives the loss of the
/// process and of power. InvalidArgument if the file cannot be opened, is not ours, or has a schema newer
/// than this program.
absl::StatusOr<std::unique_ptr<JobStore>> open_sqlite_store(const std::string& path);

}  // namespace penumbra

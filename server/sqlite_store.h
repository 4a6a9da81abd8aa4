#pragma once
#include <memory>
#include <string>

#include "proto/blob_folder.h"
#include "server/job_store.h"

namespace penumbra {

/// SQLite in WAL mode: a transaction that has returned survives what `durability` says (synchronous=FULL or
/// OFF). InvalidArgument if the file cannot be opened, is not ours, or has a schema newer than this program.
absl::StatusOr<std::unique_ptr<JobStore>> open_sqlite_store(const std::string& path,
                                                            Durability durability = Durability::kPowerLoss);

}  // namespace penumbra

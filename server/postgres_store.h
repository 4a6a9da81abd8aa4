#pragma once
#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "proto/blob_folder.h"
#include "server/job_store.h"

namespace penumbra {

/// PostgreSQL behind the job store, for servers that stand by for one another. One leads: it holds an
/// advisory lock for as long as its connection lives, and has an epoch that no other leader ever had, which
/// every transaction of its checks; one that was leader and does not know better yet can commit nothing.
///
/// `url` is libpq's (postgresql://HOST/DATABASE); a password belongs into PGPASSFILE, not here. Waits until
/// this process leads, or `give_up` becomes true (Cancelled). InvalidArgument: no connection, or a schema
/// newer than this program.
absl::StatusOr<std::unique_ptr<JobStore>> open_postgres_store(const std::string& url, Durability durability,
                                                              const std::function<bool()>& give_up);

}  // namespace penumbra

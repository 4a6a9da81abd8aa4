#pragma once
// What a store must hold, whatever has happened to it.
#include <string>
#include <vector>

#include "proto/run.h"

namespace penumbra {

/// Reads the store of a server that is not running and compares it with what the server said of its jobs,
/// all of which are final. Each task of a job that is done has exactly one result; nobody holds a lease;
/// retries are what the epochs say; every result's bytes have their digest. Empty if all is well, else what
/// is not.
std::vector<std::string> audit(const std::string& store, const std::vector<JobStatus>& jobs);

}  // namespace penumbra

#pragma once
// The undisturbed run that all disturbed ones are measured by.
#include "tests/system/cluster/cluster.h"

namespace penumbra {

std::string test_name();

/// The picture of the default spec from one worker with one thread, to which nothing happened.
const Picture& calm();

/// The job ends well, its picture is calm()'s to the bit, and no pass is missing or done twice.
RunSummary expect_calm(Cluster& cluster, const JobId& job, double seconds = 60);

}  // namespace penumbra

#pragma once
// What people are told about a job, made from the scheduler's state.
#include <string>
#include <vector>

#include "proto/run.h"
#include "server/scheduler.h"

namespace penumbra {

JobStatus status_of(const Scheduler& scheduler, const JobRecord& job, const Now& now);

/// Costs, checkpoints and rows of everything accepted so far.
RunSummary summary_of(const Scheduler& scheduler, const JobRecord& job, const Now& now);

/// Its mixes alone: without the rows of tiles, so that it may be asked for once a second.
std::vector<MixSummary> mix_summaries(const JobRecord& job);

/// CPU seconds of the server process from the job's submission to its end, or until now.
double scheduler_cpu_seconds(const JobRecord& job, const Now& now);

/// Why the job is (not) running: sentences, most important first.
std::vector<std::string> explain(const Scheduler& scheduler, const JobRecord& job, const Now& now);

}  // namespace penumbra

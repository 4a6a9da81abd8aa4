#pragma once
// What a job asks of the queue, from the command line.
#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "proto/job_terms.h"

namespace penumbra {

struct TermsOptions {
  std::string priority;
  std::vector<std::string> labels, after;
};

void add_terms_options(CLI::App& app, TermsOptions& options);
/// InvalidArgument names the flag. The user is the one who runs the program.
absl::StatusOr<JobTerms> make_terms(const TermsOptions& options);

}  // namespace penumbra

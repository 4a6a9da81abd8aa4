#pragma once
// What a job asks of the queue. None of it changes a pixel: what does is JobSpec's.
#include <cstdint>
#include <string>
#include <vector>

namespace penumbra {

struct JobTerms {
  /// Whose share the job's work counts against. Where tokens are in use the server sets it from the token.
  std::string user;
  int priority = 0;                 ///< -100 … 100; among one user's jobs the higher come first
  std::vector<std::string> labels;  ///< KEY=VALUE, for people and scripts
  std::vector<std::string> after;   ///< jobs that must be done before this one begins
  bool operator==(const JobTerms&) const = default;
};

}  // namespace penumbra

#include "client/terms.h"

#include <pwd.h>
#include <unistd.h>

#include "client/parse_text.h"
#include "proto/status.h"

namespace penumbra {

void add_terms_options(CLI::App& app, TermsOptions& o) {
  app.add_option("--priority", o.priority, "-100 to 100; of your jobs the higher come first (default 0)")
      ->type_name("N");
  app.add_option("--label", o.labels, "KEY=VALUE, for `jobs`; repeatable")
      ->type_name("LABEL")
      ->allow_extra_args(false);
  app.add_option("--after", o.after, "Begin when this job is done; repeatable")
      ->type_name("JOB")
      ->allow_extra_args(false);
}

absl::StatusOr<JobTerms> make_terms(const TermsOptions& o) {
  constexpr int kMostPriority = 100;
  JobTerms terms;
  if (const passwd* user = getpwuid(geteuid()); user != nullptr) terms.user = user->pw_name;
  if (!o.priority.empty()) {
    ASSIGN_OR_RETURN(const int64_t priority,
                     parse_whole("--priority", o.priority, -kMostPriority, kMostPriority));
    terms.priority = static_cast<int>(priority);
  }
  for (const std::string& label : o.labels)
    if (label.find('=') == std::string::npos || label.front() == '=')
      return invalid_input("--label: '{}' is not of the form KEY=VALUE", label);
  terms.labels = o.labels;
  terms.after = o.after;
  return terms;
}

}  // namespace penumbra

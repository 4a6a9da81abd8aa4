#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/outcome.h"
#include "sample_run.h"

namespace penumbra {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(OutcomeText, HasTheTableAndThePaths) {
  const std::string text = outcome_text(run_json(sample_run()), "/out/box");
  EXPECT_THAT(text,
              HasSubstr("bsdf:1+line-sa@v:3/balance        64       9.50         0.950  0.5 [0.4, 0.6]"));
  EXPECT_THAT(text, HasSubstr("\n/out/box/bsdf-4_balance.exr\n"));
  EXPECT_THAT(text, HasSubstr("\n/out/box/run.json\n/out/box/report.html\n"));
  EXPECT_THAT(text, Not(HasSubstr("interrupted")));
}

TEST(OutcomeText, SaysWhatIsMissing) {
  RunRecord run = sample_run();
  run.partial = true;
  run.mixes[0].error.reset();
  const std::string text = outcome_text(run_json(run), "/out/box");
  EXPECT_THAT(text, HasSubstr("interrupted"));
  EXPECT_THAT(text, HasSubstr("–"));
}

}  // namespace
}  // namespace penumbra

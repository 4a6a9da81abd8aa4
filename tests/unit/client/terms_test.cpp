#include "client/terms.h"

#include <gtest/gtest.h>

#include "proto/status.h"

namespace penumbra {
namespace {

TEST(Terms, AreTakenAsTyped) {
  const auto terms = make_terms({"-7", {"shot=12", "x=a=b"}, {"j1"}});
  ASSERT_TRUE(terms.ok()) << terms.status();
  EXPECT_EQ(terms->priority, -7);
  EXPECT_EQ(terms->labels, (std::vector<std::string>{"shot=12", "x=a=b"}));
  EXPECT_EQ(terms->after, std::vector<std::string>{"j1"});
  EXPECT_FALSE(terms->user.empty());
}

TEST(Terms, FaultsNameTheirFlag) {
  for (const auto& [options, flag] :
       std::initializer_list<std::pair<TermsOptions, const char*>>{{{"101", {}, {}}, "--priority"},
                                                                   {{"-101", {}, {}}, "--priority"},
                                                                   {{"high", {}, {}}, "--priority"},
                                                                   {{"", {"shot"}, {}}, "--label"},
                                                                   {{"", {"=12"}, {}}, "--label"},
                                                                   {{"", {""}, {}}, "--label"}}) {
    const auto terms = make_terms(options);
    ASSERT_FALSE(terms.ok());
    EXPECT_EQ(message_of(terms.status()).find(flag), 0u) << terms.status();
  }
}

}  // namespace
}  // namespace penumbra

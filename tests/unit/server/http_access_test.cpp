#include "server/http_access.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

const HttpAccess kOpen{{}, true}, kGuarded{*parse_token_file("tokens", "s3cret:x\n"), false};

TEST(HttpAccess, OnlyReads) {
  EXPECT_EQ(refusal(kOpen, "/", {"GET", "localhost:7401", ""}), std::nullopt);
  EXPECT_EQ(refusal(kOpen, "/", {"HEAD", "127.0.0.1:7401", ""}), std::nullopt);
  for (const char* method : {"POST", "PUT", "DELETE", "get", ""})
    EXPECT_EQ(refusal(kOpen, "/", {method, "localhost", ""}), 405) << method;
}

TEST(HttpAccess, OnLoopbackAForeignNameIsRefused) {
  for (const char* host : {"localhost", "127.0.0.1", "[::1]", "[::1]:7401"})
    EXPECT_EQ(refusal(kOpen, "/", {"GET", host, ""}), std::nullopt) << host;
  for (const char* host :
       {"evil.example", "evil.example:7401", "localhost.evil.example", "", "127.0.0.1.evil"})
    EXPECT_EQ(refusal(kOpen, "/", {"GET", host, ""}), 403) << host;
}

TEST(HttpAccess, TheTokenComesAsBearerOrAsPassword) {
  EXPECT_EQ(refusal(kGuarded, "/metrics", {"GET", "farm", "Bearer s3cret:x"}), std::nullopt);
  EXPECT_EQ(refusal(kGuarded, "/metrics", {"GET", "farm", "Basic YW55OnMzY3JldDp4"}),
            std::nullopt);  // any:s3cret:x
  for (const char* shown : {"", "Bearer", "Bearer s3cret", "Bearer s3cret:x ", "bearer s3cret:x",
                            "Basic czNjcmV0Ong=", "Basic %%%", "s3cret:x"})
    EXPECT_EQ(refusal(kGuarded, "/metrics", {"GET", "farm", shown}), 401) << shown;
}

TEST(HttpAccess, HealthNeedsNoToken) {
  EXPECT_EQ(refusal(kGuarded, "/healthz", {"GET", "farm", ""}), std::nullopt);
  EXPECT_EQ(refusal(kGuarded, "/healthz/", {"GET", "farm", ""}), 401);
}

}  // namespace
}  // namespace penumbra

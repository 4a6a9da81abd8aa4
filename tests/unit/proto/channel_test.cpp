#include "proto/channel.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

TEST(Channel, LoopbackIsAnAddressNotAPrefix) {
  for (const char* inside : {"127.0.0.1:7400", "localhost:1", "[::1]:7400", "127.9.9.9:0"})
    EXPECT_TRUE(is_loopback(inside)) << inside;
  for (const char* outside :
       {"0.0.0.0:7400", "127.evil.example:1", "10.0.0.1:7400", "[::]:7400", "localhost.x:1"})
    EXPECT_FALSE(is_loopback(outside)) << outside;
}

TEST(Channel, FlagsThatDoNotFitAreNamed) {
  EXPECT_TRUE(absl::IsInvalidArgument(open_channel("nowhere", {}).status()));
  Credentials token_only;
  token_only.token_file = "t";
  EXPECT_TRUE(absl::IsInvalidArgument(open_channel("127.0.0.1:1", token_only).status()));
  Credentials cert_only;
  cert_only.cert = "c";
  EXPECT_TRUE(absl::IsInvalidArgument(open_channel("127.0.0.1:1", cert_only).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(read_token("/nonexistent/token").status()));
}

}  // namespace
}  // namespace penumbra

#include "server/token_file.h"

#include <gtest/gtest.h>

#include "proto/status.h"

namespace penumbra {
namespace {

constexpr std::string_view kFile = R"(
# the studio
alpha ada submit jobs=3 tasks=8 rate=100
beta farm work
gamma root admin
)";

TEST(TokenFile, EveryLineIsAnEntry) {
  const auto entries = parse_token_file("tokens", kFile);
  ASSERT_TRUE(entries.ok()) << entries.status();
  ASSERT_EQ(entries->size(), 3u);
  const TokenEntry* ada = find_token(*entries, "alpha");
  ASSERT_NE(ada, nullptr);
  EXPECT_EQ(ada->user, "ada");
  EXPECT_EQ(ada->quota.jobs, 3u);
  EXPECT_EQ(ada->quota.leases, 8u);
  EXPECT_EQ(ada->requests_per_second, 100);
  EXPECT_EQ(find_token(*entries, "beta")->user, "farm");
  for (const std::string wrong : {"", "alph", "alphaa", "ALPHA", "ada", "alpha ada submit"})
    EXPECT_EQ(find_token(*entries, wrong), nullptr) << wrong;
}

TEST(TokenFile, RolesAllowWhatTheyAreFor) {
  const auto entries = parse_token_file("tokens", kFile);
  ASSERT_TRUE(entries.ok());
  const auto allowed = [&](const char* token, const char* method) {
    return allows(*find_token(*entries, token), method);
  };
  EXPECT_TRUE(allowed("alpha", "/penumbra.v1.Render/Submit"));
  EXPECT_TRUE(allowed("alpha", "/penumbra.v1.Blobs/Upload"));
  EXPECT_FALSE(allowed("alpha", "/penumbra.v1.Worker/Sync"));
  EXPECT_TRUE(allowed("beta", "/penumbra.v1.Worker/Sync"));
  EXPECT_TRUE(allowed("beta", "/penumbra.v1.Blobs/Download"));
  EXPECT_FALSE(allowed("beta", "/penumbra.v1.Render/Cancel"));
  for (const char* token : {"alpha", "beta"}) {
    EXPECT_FALSE(allowed(token, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo"));
    EXPECT_FALSE(allowed(token, ""));
    EXPECT_TRUE(allowed(token, "/grpc.health.v1.Health/Check"));
  }
  EXPECT_TRUE(allowed("gamma", "/penumbra.v1.Worker/Sync"));
  EXPECT_TRUE(allowed("gamma", "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo"));
}

TEST(TokenFile, ALoneTokenMayDoEverything) {
  const auto entries = parse_token_file("tokens", "s3cret\n");
  ASSERT_TRUE(entries.ok());
  EXPECT_TRUE(allows(*find_token(*entries, "s3cret"), "/penumbra.v1.Render/Cancel"));
}

TEST(TokenFile, FaultsNameTheLineAndNeverTheToken) {
  for (const std::string text :
       {"", "# only a comment\n", "s3cret ada\n", "\ns3cret ada king\n", "s3cret ada submit jobs=0\n",
        "s3cret ada submit jobs=x\n", "s3cret ada submit cats=1\n", "s3cret a submit\ns3cret b work\n"}) {
    const auto entries = parse_token_file("tokens", text);
    ASSERT_FALSE(entries.ok()) << text;
    EXPECT_TRUE(absl::IsInvalidArgument(entries.status()));
    EXPECT_NE(message_of(entries.status()).find("--token-file: tokens"), std::string::npos);
    EXPECT_EQ(message_of(entries.status()).find("s3cret"), std::string::npos);
  }
}

}  // namespace
}  // namespace penumbra

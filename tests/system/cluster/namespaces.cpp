#include "tests/system/cluster/namespaces.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace penumbra {
namespace {

bool run(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace

TwoNetworks::TwoNetworks() : name_(fmt::format("penumbra-{}", getpid())), missing_(make()) {}

TwoNetworks::~TwoNetworks() {
  // The cable has its end in it, and goes with it.
  if (!name_.empty()) (void)run("ip netns delete " + name_);
}

std::string TwoNetworks::make() {
  if (!run("ip -V")) return "ip(8) is not installed";
  if (unshare(CLONE_NEWNET) != 0) return fmt::format("no network of our own: {}", std::strerror(errno));
  if (!run("ip netns add " + name_)) return "no second network: ip netns add";
  const std::string commands[] = {
      "ip link set lo up",
      "ip link add near type veth peer name far netns " + name_,
      fmt::format("ip address add {}/30 dev near", near()),
      "ip link set near up",
      fmt::format("ip -n {} address add {}/30 dev far", name_, far()),
      fmt::format("ip -n {} link set lo up", name_),
      fmt::format("ip -n {} link set far up", name_),
  };
  for (const std::string& command : commands) EXPECT_TRUE(run(command)) << command;
  return "";
}

/// Frames to a hardware address that nobody has: the other end drops them.
void TwoNetworks::cut() {
  EXPECT_TRUE(run(fmt::format("ip neigh replace {} lladdr 02:00:00:00:00:99 nud permanent dev near", far())));
  EXPECT_TRUE(run(fmt::format("ip -n {} neigh replace {} lladdr 02:00:00:00:00:99 nud permanent dev far",
                              name_, near())));
}

void TwoNetworks::heal() {
  EXPECT_TRUE(run(fmt::format("ip neigh delete {} dev near", far())));
  EXPECT_TRUE(run(fmt::format("ip -n {} neigh delete {} dev far", name_, near())));
}

}  // namespace penumbra

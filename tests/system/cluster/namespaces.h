#pragma once
// A network of its own for a test, and one for what is to be cut off from it (ip-netns(8), veth(4)).
#include <string>
#include <vector>

namespace penumbra {

/// The calling process moves into a network where it is alone, at `near()`; a second network with one other
/// host, `far()`, is reached over a cable that can be cut. Threads that were there before stay where they
/// are: to be made first. What is made goes with the object.
class TwoNetworks {
 public:
  TwoNetworks();
  ~TwoNetworks();
  TwoNetworks(const TwoNetworks&) = delete;
  TwoNetworks& operator=(const TwoNetworks&) = delete;

  /// Why there are none (no permission, no ip(8)); empty: there are.
  const std::string& missing() const { return missing_; }
  static std::string near() { return "10.93.7.1"; }
  static std::string far() { return "10.93.7.2"; }
  /// What a command that runs on the far side begins with.
  std::vector<std::string> far_prefix() const { return {"ip", "netns", "exec", name_}; }
  /// From now on whatever one side sends is lost, and nobody is told: as if a switch had died.
  void cut();
  void heal();

 private:
  std::string make();

  std::string name_, missing_;
};

}  // namespace penumbra

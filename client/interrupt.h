#pragma once
// Ctrl-C and SIGTERM as a stop token.
#include <stop_token>

namespace penumbra {

/// Blocks SIGINT and SIGTERM in the calling thread (call it first thing in main: threads inherit the
/// mask) and receives them on a thread of its own. The first one stops the token; the second one ends
/// the program at once with exit code 130 (local children die with it).
class Interrupt {
 public:
  Interrupt();
  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
};

}  // namespace penumbra

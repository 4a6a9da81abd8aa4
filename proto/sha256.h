#pragma once
// SHA-256 of bytes that come in pieces.
#include <memory>
#include <string>
#include <string_view>

namespace penumbra {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  void add(std::string_view bytes);
  /// 64 lower-case hexadecimal digits. Call once.
  std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace penumbra

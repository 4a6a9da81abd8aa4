#pragma once
// SHA-256: the name of every blob.
#include <memory>
#include <string>
#include <string_view>

namespace penumbra {

/// Of bytes that come in pieces.
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

/// Of bytes that are all there.
std::string sha256(std::string_view bytes);

}  // namespace penumbra

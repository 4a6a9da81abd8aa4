#pragma once
// Little-endian bytes of numbers and arrays, bounds checked on the way back.
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace penumbra {

static_assert(std::endian::native == std::endian::little,
              "the formats are little-endian and copied as they lie");

class ByteWriter {
 public:
  template <class Number>
  void put(Number value) {
    static_assert(std::is_arithmetic_v<Number>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class Number>
  void put(const std::vector<Number>& values) {
    static_assert(std::is_arithmetic_v<Number>);
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number));
  }
  void put(std::string_view text) { bytes_.append(text); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : left_(bytes) {}

  /// The next number; false (and the value untouched) if the bytes end before it.
  template <class Number>
  bool get(Number& value) {
    static_assert(std::is_arithmetic_v<Number>);
    if (left_.size() < sizeof value) return false;
    std::memcpy(&value, left_.data(), sizeof value);
    left_.remove_prefix(sizeof value);
    return true;
  }
  /// `count` numbers where they lie; false if the bytes end before them. They must lie at a multiple of
  /// their size, as everything does in a string whose fields before them are such multiples.
  template <class Number>
  bool view(std::span<const Number>& values, uint64_t count) {
    static_assert(std::is_arithmetic_v<Number>);
    if (count > left_.size() / sizeof(Number)) return false;
    if (reinterpret_cast<uintptr_t>(left_.data()) % alignof(Number) != 0) return false;
    values = {reinterpret_cast<const Number*>(left_.data()), count};
    left_.remove_prefix(count * sizeof(Number));
    return true;
  }
  bool expect(std::string_view text) {
    if (!left_.starts_with(text)) return false;
    left_.remove_prefix(text.size());
    return true;
  }
  size_t left() const { return left_.size(); }

 private:
  std::string_view left_;
};

}  // namespace penumbra

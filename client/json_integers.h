#pragma once
// Integers of files that anybody may have written. nlohmann's own get<int>() takes any number: 1e300 would be
// made an integer, which is undefined, and 2^32 would be 0.
#include <fmt/format.h>

#include <utility>
#include <vector>

#include "client/job_json.h"

namespace penumbra {

/// Throws what nlohmann::json throws unless it is an integer of the type's range.
template <class Integer>
Integer integer_of(const Json& json) {
  const auto in_range = [](auto value) { return std::in_range<Integer>(value); };
  if (json.is_number_unsigned() && in_range(json.get<uint64_t>()))
    return static_cast<Integer>(json.get<uint64_t>());
  if (json.is_number_integer() && !json.is_number_unsigned() && in_range(json.get<int64_t>()))
    return static_cast<Integer>(json.get<int64_t>());
  throw Json::out_of_range::create(
      406, fmt::format("{} is no integer of this range", json.dump(-1, ' ', true)), &json);
}

/// Likewise of a list of them.
template <class Integer>
std::vector<Integer> integers_of(const Json& json) {
  if (!json.is_array()) throw Json::type_error::create(302, "not a list of integers", &json);
  std::vector<Integer> out;
  for (const Json& element : json) out.push_back(integer_of<Integer>(element));
  return out;
}

}  // namespace penumbra

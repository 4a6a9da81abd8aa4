#pragma once
// Reads the battery of numerical hard cases: CSV, comma separated, one header line, no quoting, an empty
// field where a column does not apply. Inputs are binary32 numbers printed with 9 digits (single() recovers
// them exactly); references have up to 25 digits.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "scenes/math.h"

namespace penumbra::numerics {

/// One line of a table. A column that does not exist, or a field that is no number, is a fault of the
/// battery or the test, and throws: no row may pass because it was not read.
class Row {
 public:
  using Columns = std::map<std::string, size_t>;
  Row(std::shared_ptr<const Columns> columns, std::vector<std::string> fields)
      : columns_(std::move(columns)), fields_(std::move(fields)) {}

  const std::string& text(const std::string& column) const {
    const auto found = columns_->find(column);
    if (found == columns_->end()) throw std::runtime_error("battery: no column '" + column + "'");
    return fields_.at(found->second);
  }
  bool has(const std::string& column) const { return !text(column).empty(); }

  /// A binary32 input.
  float single(const std::string& column) const {
    return parse<float>(column, [](const char* s, char** end) { return std::strtof(s, end); });
  }
  /// A reference value, in the widest type at hand so that reading it costs no digit of the comparison.
  long double reference(const std::string& column) const {
    return parse<long double>(column, [](const char* s, char** end) { return std::strtold(s, end); });
  }
  double number(const std::string& column) const { return static_cast<double>(reference(column)); }
  int integer(const std::string& column) const { return static_cast<int>(reference(column)); }

  /// `17 graze_in`: which row a message speaks of.
  std::string label() const { return std::string(text("id")).append(" ").append(text("cls")); }

  /// Columns <prefix>x, <prefix>y, <prefix>z.
  Vec3f vector(const std::string& prefix) const {
    return {single(prefix + "x"), single(prefix + "y"), single(prefix + "z")};
  }

 private:
  template <class Number, class Convert>
  Number parse(const std::string& column, Convert convert) const {
    const std::string& field = text(column);
    char* end = nullptr;
    const Number value = convert(field.c_str(), &end);
    if (field.empty() || *end != '\0')
      throw std::runtime_error("battery: '" + field + "' in column '" + column + "' is no number");
    return value;
  }

  std::shared_ptr<const Columns> columns_;
  std::vector<std::string> fields_;
};

/// Folder of the battery: PENUMBRA_NUMERICS_DIR, else the project's own copy.
inline std::string battery_folder() {
  const char* folder = std::getenv("PENUMBRA_NUMERICS_DIR");
  return folder != nullptr && *folder != '\0' ? folder : PENUMBRA_SOURCE_DIR "/tests/numerics/data";
}

/// The fields of one line; `a,,` has three.
inline std::vector<std::string> split_fields(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',')
      fields.emplace_back();
    else if (c != '\r')
      fields.back() += c;
  }
  return fields;
}

/// All rows of `<folder>/<name>.csv`; throws if it cannot be read, is empty or ragged.
inline std::vector<Row> read_battery(const std::string& name) {
  const std::string path = battery_folder() + "/" + name + ".csv";
  std::ifstream in(path);
  std::string line;
  if (!in || !std::getline(in, line)) throw std::runtime_error("battery: cannot read " + path);
  auto columns = std::make_shared<Row::Columns>();
  for (const std::string& column : split_fields(line)) columns->emplace(column, columns->size());
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    if (line.empty()) continue;
    std::vector<std::string> fields = split_fields(line);
    if (fields.size() != columns->size()) throw std::runtime_error("battery: ragged line in " + path);
    rows.emplace_back(columns, std::move(fields));
  }
  if (rows.empty()) throw std::runtime_error("battery: no rows in " + path);
  return rows;
}

}  // namespace penumbra::numerics

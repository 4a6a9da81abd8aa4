#pragma once
// The battery's verdicts: each comparison is judged at once against its tolerance, and the worst of every
// quantity is kept for the table that a family prints at its end.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <string>

namespace penumbra::numerics {

/// Unit roundoff of binary64.
constexpr double kEpsilon = 0x1p-53;

/// error = |value - reference| in units of eps * scale, where scale is (1 + cond) times whatever the
/// quantity is measured against (1 for an absolute error, the reference for a relative one).
class WorstErrors {
 public:
  explicit WorstErrors(std::string family) : family_(std::move(family)) {}
  WorstErrors(const WorstErrors&) = delete;
  WorstErrors& operator=(const WorstErrors&) = delete;
  ~WorstErrors() { print(); }

  /// Fails the running test if C = error/(eps*scale) is above `allowed` or not a number.
  void check(const std::string& quantity, const std::string& row, long double value, long double reference,
             long double scale, double allowed) {
    const long double error = std::abs(value - reference);
    const double c = error == 0 ? 0.0 : static_cast<double>(error / (kEpsilon * scale));
    Worst& worst = worst_[quantity];
    ++worst.rows;
    worst.allowed = allowed;
    if (worst.row.empty() || !(c <= worst.c)) worst = {c, allowed, row, worst.rows};
    EXPECT_TRUE(c <= allowed) << family_ << " " << quantity << ", row " << row << ": got "
                              << static_cast<double>(value) << ", reference "
                              << static_cast<double>(reference) << ", C = " << c << " > " << allowed;
  }
  void relative(const std::string& quantity, const std::string& row, long double value, long double reference,
                long double cond, double allowed) {
    check(quantity, row, value, reference, (1 + cond) * std::abs(reference), allowed);
  }
  void absolute(const std::string& quantity, const std::string& row, long double value, long double reference,
                long double cond, double allowed) {
    check(quantity, row, value, reference, 1 + cond, allowed);
  }

 private:
  struct Worst {
    double c = 0, allowed = 0;
    std::string row;
    int rows = 0;
  };

  void print() const {
    std::printf("%-24s %-16s %6s %12s %10s  %s\n", "family", "quantity", "rows", "worst C", "allowed", "at");
    for (const auto& [quantity, worst] : worst_)
      std::printf("%-24s %-16s %6d %12.3g %10.3g  %s\n", family_.c_str(), quantity.c_str(), worst.rows,
                  worst.c, worst.allowed, worst.row.c_str());
  }

  std::string family_;
  std::map<std::string, Worst> worst_;
};

}  // namespace penumbra::numerics

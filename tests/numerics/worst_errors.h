#pragma once
// The battery's verdicts: each comparison is judged at once against its tolerance, and the worst of every
// quantity is kept for the one table that a program prints at its end.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <utility>

namespace penumbra::numerics {

/// Unit roundoff of binary64, and of binary32.
constexpr double kEpsilon = 0x1p-53, kEpsilonSingle = 0x1p-24;

/// The worst C of one quantity of one family.
struct WorstError {
  double c = 0, allowed = 0, roundoff = kEpsilon;
  std::string row;
  int rows = 0;
};

/// Printed when the program's tests are over: C = error / (roundoff × scale) per family and quantity.
class WorstErrorTable : public testing::Environment {
 public:
  static WorstErrorTable& instance() {
    // Google Test owns it.
    static auto* const table =
        static_cast<WorstErrorTable*>(testing::AddGlobalTestEnvironment(new WorstErrorTable));
    return *table;
  }
  void add(const std::string& family, const std::string& quantity, const WorstError& worst) {
    worst_[{family, quantity}] = worst;
  }
  void TearDown() override {
    std::printf("%-18s %-14s %6s %6s %10s %9s  %s\n", "family", "quantity", "eps", "rows", "worst C",
                "allowed", "at row");
    for (const auto& [name, worst] : worst_)
      std::printf("%-18s %-14s  2^%3d %6d %10.3g %9.3g  %s\n", name.first.c_str(), name.second.c_str(),
                  std::ilogb(worst.roundoff), worst.rows, worst.c, worst.allowed, worst.row.c_str());
  }

 private:
  std::map<std::pair<std::string, std::string>, WorstError> worst_;
};

/// The table must be known to Google Test before the tests run.
inline WorstErrorTable& worst_error_table = WorstErrorTable::instance();

/// error = |value - reference| in units of roundoff * scale, where scale is (1 + cond) times whatever the
/// quantity is measured against (1 for an absolute error, the reference for a relative one).
class WorstErrors {
 public:
  /// `roundoff`: of the precision in which the product computes the family.
  explicit WorstErrors(std::string family, double roundoff = kEpsilon)
      : family_(std::move(family)), roundoff_(roundoff) {}
  WorstErrors(const WorstErrors&) = delete;
  WorstErrors& operator=(const WorstErrors&) = delete;
  ~WorstErrors() {
    for (const auto& [quantity, worst] : worst_) worst_error_table.add(family_, quantity, worst);
  }

  /// Fails the running test if C = error/(roundoff*scale) is above `allowed` or not a number.
  void check(const std::string& quantity, const std::string& row, long double value, long double reference,
             long double scale, double allowed) {
    const long double error = std::abs(value - reference);
    const double c = error == 0 ? 0.0 : static_cast<double>(error / (roundoff_ * scale));
    WorstError& worst = worst_[quantity];
    ++worst.rows;
    if (worst.row.empty() || !(c <= worst.c)) worst = {c, allowed, roundoff_, row, worst.rows};
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
  std::string family_;
  double roundoff_;
  std::map<std::string, WorstError> worst_;
};

}  // namespace penumbra::numerics

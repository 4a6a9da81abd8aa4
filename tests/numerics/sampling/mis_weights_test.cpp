// f7: weights of multiple importance sampling for densities of any size, zero and infinite.
#include "tests/numerics/csv.h"
#include "tests/numerics/worst_errors.h"
#include "worker/sampling/mis.h"

namespace penumbra::numerics {
namespace {

constexpr int kMostStrategies = 5;
constexpr const char* kCount[] = {"n0", "n1", "n2", "n3", "n4"};
constexpr const char* kPdf[] = {"p0", "p1", "p2", "p3", "p4"};
constexpr const char* kSmoothing[] = {"s0", "s1", "s2", "s3", "s4"};
constexpr const char* kBalance[] = {"wb0", "wb1", "wb2", "wb3", "wb4"};
constexpr const char* kPower[] = {"wp0", "wp1", "wp2", "wp3", "wp4"};

TEST(Battery, F7MisWeights) {
  WorstErrors errors("f7_mis_weights");
  for (const Row& row : read_battery("f7_mis_weights")) {
    const int k = row.integer("k");
    ASSERT_LE(k, kMostStrategies);
    std::vector<double> counts, pdfs, smoothing, balance(k, -1), power(k, -1);
    for (int i = 0; i < k; ++i) {
      counts.push_back(row.integer(kCount[i]));
      pdfs.push_back(row.single(kPdf[i]));
      smoothing.push_back(row.single(kSmoothing[i]));
    }
    balance_weights(counts, pdfs, smoothing, balance);
    power_weights(counts, pdfs, power);
    for (int i = 0; i < k; ++i) {
      errors.absolute("balance", row.label(), balance[i], row.reference(kBalance[i]), 0, 8);
      errors.absolute("power", row.label(), power[i], row.reference(kPower[i]), 0, 8);
    }
    const double sum = inverse_sum(counts, pdfs);
    if (std::isinf(row.reference("inv_sum")))
      EXPECT_EQ(sum, std::numeric_limits<double>::infinity()) << row.label();
    else
      errors.relative("inverse_sum", row.label(), sum, row.reference("inv_sum"), 0, 8);
  }
}

}  // namespace
}  // namespace penumbra::numerics

// f8b: the part of a line whose distance from x lies in [t0,t1): what a bin gets of a chord.
#include "tests/numerics/csv.h"
#include "tests/numerics/worst_errors.h"
#include "worker/effects/transient.h"

namespace penumbra::numerics {
namespace {

TEST(Battery, F8bTimeBins) {
  WorstErrors errors("f8b_time_bins");
  static constexpr const char* kLow[] = {"lo0", "lo1"};
  static constexpr const char* kHigh[] = {"hi0", "hi1"};
  const std::vector<Interval> all = {{0, 1}};
  std::vector<LinePart> parts;
  for (const Row& row : read_battery("f8b_time_bins")) {
    const Vec3d x(row.vector("x")), a(row.vector("a")), b(row.vector("b"));
    LightLine line;
    line.corner = a;
    line.along = b - a;
    TimeBins bins(Transient{row.single("t0"), row.single("t1"), 1});
    bins.stand_at(0, Rgb(1));
    bins.cut(line, x, all, parts);
    const int n = row.integer("n");
    const double cond = row.number("cond");
    if (int(parts.size()) != n) {  // bins that touch: the measure decides
      double measure = 0;
      long double reference = 0;
      for (const LinePart& part : parts) measure += part.hi - part.lo;
      for (int k = 0; k < n; ++k) reference += row.reference(kHigh[k]) - row.reference(kLow[k]);
      errors.absolute("measure", row.label(), measure, reference, cond, 32);
      continue;
    }
    for (int k = 0; k < n; ++k) {
      errors.absolute("lo", row.label(), parts[size_t(k)].lo, row.reference(kLow[k]), cond, 16);
      errors.absolute("hi", row.label(), parts[size_t(k)].hi, row.reference(kHigh[k]), cond, 16);
    }
  }
}

}  // namespace
}  // namespace penumbra::numerics

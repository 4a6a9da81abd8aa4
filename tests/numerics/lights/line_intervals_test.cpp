// f2b: a point on the visible part of a chord, uniform in the angular measure and uniform in length.
#include "tests/numerics/lights/rectangle_row.h"

namespace penumbra::numerics {
namespace {

std::vector<Interval> visible_intervals(const Row& row) {
  static constexpr const char* kLow[] = {"a0", "a1", "a2"};
  static constexpr const char* kHigh[] = {"b0", "b1", "b2"};
  std::vector<Interval> visible;
  for (int k = 0; k < row.integer("n"); ++k) visible.push_back({row.single(kLow[k]), row.single(kHigh[k])});
  return visible;
}

TEST(Battery, F2bLineIntervals) {
  WorstErrors errors("f2b_line_intervals");
  for (const Row& row : read_battery("f2b_line_intervals")) {
    const RectangleRow r(row);
    const SeenShape seen(r.shape, r.x);
    const std::vector<Interval> visible = visible_intervals(row);
    const double v = row.single("v");
    LightLine line = choose_line_solid_angle(seen, false, row.single("u"));
    const double measure = visible_measure(line, visible);
    errors.absolute("fv_h", r.name, sample_parameter(line, visible, measure, v), row.reference("fv_h"),
                    row.reference("cond_fv"), 16);
    errors.relative("pdf_omega", r.name, sample_line(line, r.x, visible, v).pdf, row.reference("pdf_omega"),
                    row.reference("cond_pdf"), 16);
    // The same chord, uniform in length: the density per length is 1 over the visible length.
    line.measure = LengthMeasure{};
    const double fraction = visible_measure(line, visible);
    errors.absolute("fv_len", r.name, sample_parameter(line, visible, fraction, v), row.reference("fv_len"),
                    0, 8);
    errors.relative("pdf_len", r.name, 1 / (fraction * line.along.length()), row.reference("pdf_len"), 0, 16);
  }
}

}  // namespace
}  // namespace penumbra::numerics

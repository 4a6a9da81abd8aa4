// f3: from a point of the rectangle back to the random numbers, and its densities.
#include "tests/numerics/lights/rectangle_row.h"

namespace penumbra::numerics {
namespace {

TEST(Battery, F3Inverse) {
  WorstErrors errors("f3_inverse");
  for (const Row& row : read_battery("f3_inverse")) {
    const RectangleRow r(row);
    const SphericalRectangle rectangle = r.rectangle();
    const Vec2d f(row.single("fu"), row.single("fv"));
    const Vec2d u = rectangle.invert(f);
    errors.absolute("u", r.name, u.x, row.reference("u"), row.reference("cond_u"), 16);
    errors.absolute("v", r.name, u.y, row.reference("v"), row.reference("cond_v"), 16);
    errors.relative("pdf_omega", r.name, 1 / rectangle.solid_angle(), row.reference("pdf_omega"),
                    row.reference("cond"), 8);
    errors.relative("pdf_area", r.name, rectangle.pdf_area(f), row.reference("pdf_area"),
                    row.reference("cond_pA"), 16);
    errors.relative("pdf_x", r.name, rectangle.pdf_offset(rectangle.chord_at(false, f.x)),
                    row.reference("pdf_x"), row.reference("cond_px"), 16);
  }
}

}  // namespace
}  // namespace penumbra::numerics

// f1: the solid angle of rectangles, C <= 8; 0 for a point in the rectangle's plane.
#include "tests/numerics/lights/rectangle_row.h"

namespace penumbra::numerics {
namespace {

TEST(Battery, F1SolidAngle) {
  WorstErrors errors("f1_solid_angle");
  for (const Row& row : read_battery("f1_solid_angle")) {
    const RectangleRow r(row);
    const SeenShape seen(r.shape, r.x);
    if (row.text("cls") == "coplanar") {
      EXPECT_EQ(seen.solid_angle(), 0) << r.name;
      EXPECT_EQ(seen.pdf(Vec3d(r.quad.o), Vec3d(0, 0, 1)), 0) << r.name;
      EXPECT_EQ(seen.sample({0.5, 0.5}).pdf, 0) << r.name;
      EXPECT_EQ(sample_area(r.shape, r.x, {0.5, 0.5}).pdf, 0) << r.name;
      continue;
    }
    errors.relative("omega", r.name, seen.solid_angle(), row.reference("omega"), row.reference("cond"), 8);
  }
}

}  // namespace
}  // namespace penumbra::numerics

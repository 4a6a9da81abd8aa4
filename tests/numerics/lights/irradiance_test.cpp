// f5, f5b: irradiance from a rectangle, unoccluded and in the penumbra of one triangle.
#include "worker/lights/irradiance.h"

#include "tests/numerics/lights/rectangle_row.h"

namespace penumbra::numerics {
namespace {

/// A vector of the row, mirrored like the rectangle.
Vec3d mirrored(const RectangleRow& r, const Vec3f& v) {
  return {r.mirrored ? -v.x : v.x, v.y, v.z};
}

TEST(Battery, F5Irradiance) {
  WorstErrors errors("f5_irradiance");
  for (const Row& row : read_battery("f5_irradiance")) {
    const RectangleRow r(row);
    const Vec3d n = mirrored(r, row.vector("n")).normalized();
    const long double e = row.reference("E");
    const long double scale = (1 + row.reference("cond")) * e + row.reference("escale");
    errors.check(e == 0 ? "E = 0" : "E", r.name, irradiance(r.shape, r.x, n), e, scale, 16);
  }
}

TEST(Battery, F5bPenumbra) {
  WorstErrors errors("f5b_penumbra");
  for (const Row& row : read_battery("f5b_penumbra")) {
    const RectangleRow r(row);
    const Vec3d n = mirrored(r, row.vector("n")).normalized();
    const std::array<Vec3d, 3> occluder = {mirrored(r, row.vector("o0")), mirrored(r, row.vector("o1")),
                                           mirrored(r, row.vector("o2"))};
    const long double e = row.reference("E"), unoccluded = row.reference("E_unocc"),
                      cond = row.reference("cond");
    errors.check("E", r.name, irradiance_behind(r.shape, r.x, n, occluder), e, (1 + cond) * e + unoccluded,
                 16);
    // E_unocc has no condition number of its own; the row's is that of the harder, occluded problem.
    errors.relative("E_unocc", r.name, irradiance(r.shape, r.x, n), unoccluded, cond, 16);
  }
}

}  // namespace
}  // namespace penumbra::numerics

// f2: points uniform in the solid angle of rectangles, their densities, and the density of the line's offset.
#include "tests/numerics/lights/rectangle_row.h"

namespace penumbra::numerics {
namespace {

TEST(Battery, F2Sample) {
  WorstErrors errors("f2_sample");
  for (const Row& row : read_battery("f2_sample")) {
    const RectangleRow r(row);
    const SphericalRectangle rectangle = r.rectangle();
    const Vec2d u(row.single("u"), row.single("v"));
    const Vec2d f = rectangle.sample(u);
    errors.absolute("fu", r.name, f.x, row.reference("fu"), row.reference("cond_fu"), 16);
    errors.absolute("fv", r.name, f.y, row.reference("fv"), row.reference("cond_fv"), 16);

    const SeenShape seen(r.shape, r.x);
    const LightPoint point = seen.sample(u);
    errors.relative("pdf_omega", r.name, point.pdf, row.reference("pdf_omega"), row.reference("cond"), 8);
    errors.relative("pdf_area", r.name, rectangle.pdf_area(f), row.reference("pdf_area"),
                    row.reference("cond_pA"), 16);
    const RectangleChord chord = rectangle.chord(false, u.x);
    errors.relative("pdf_x", r.name, rectangle.pdf_offset(chord), row.reference("pdf_x"),
                    row.reference("cond_px"), 16);
    // The same chord as a light line.
    const LightLine line = choose_line_solid_angle(seen, false, u.x);
    errors.absolute("fu (line)", r.name, (line.from).dot(Vec3d(r.quad.u)) / Vec3d(r.quad.u).length2(),
                    row.reference("fu"), row.reference("cond_fu"), 16);
    // The point in the world, where its own rounding allows: half a unit in the last place of coordinates as
    // large as the scene's offset, and the fractions' error times the edges.
    const char* names[] = {"qx", "qy", "qz"};
    for (int k = 0; k < 3; ++k) {
      const double reference = (k == 0 && r.mirrored ? -1 : 1) * row.reference(names[k]);
      const double extent = std::abs(r.quad.o[k]) + (1 + row.number("cond_fu")) * std::abs(r.quad.u[k]) +
                            (1 + row.number("cond_fv")) * std::abs(r.quad.v[k]);
      errors.check("q", r.name, point.p[k], reference, extent, 16);
    }
  }
}

}  // namespace
}  // namespace penumbra::numerics

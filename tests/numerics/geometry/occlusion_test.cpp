// Families f4 and f4b: what one triangle, and the union of a mesh's triangles, hides of a chord. The fan and
// the triangle test are the product's own, in single precision, so eps = 2^-24.
#include <cmath>

#include "tests/numerics/csv.h"
#include "tests/numerics/worst_errors.h"
#include "worker/geometry/geometry.h"
#include "worker/geometry/line_fan.h"

namespace penumbra {
namespace {

using numerics::read_battery;
using numerics::Row;
using numerics::WorstErrors;

constexpr double kSingle = kFloatRoundoff / numerics::kEpsilon;  // allowed errors in units of 2^-53

LineFan fan_of(const Vec3f& x, const Vec3f& a, const Vec3f& b, const Vec3f p[3]) {
  double reach = 0;
  for (int i = 0; i < 3; ++i) reach = std::max(reach, (Vec3d(p[i]) - Vec3d(x)).length());
  return make_fan(Vec3d(x), Vec3d(a) - Vec3d(x), Vec3d(b) - Vec3d(x), reach);
}

TEST(Occlusion, OneTriangle) {
  WorstErrors errors("f4");
  for (const Row& row : read_battery("f4_visibility_triangle")) {
    const std::string name = row.text("id") + " " + row.text("cls");
    const Vec3f p[3] = {row.vector("v0"), row.vector("v1"), row.vector("v2")};
    const LineFan fan = fan_of(row.vector("x"), row.vector("a"), row.vector("b"), p);
    const Interval hidden = fan.degenerate ? kHidesNothing : hidden_by_triangle(fan, p);
    const bool hides = hidden.lo < hidden.hi;
    const double length = hides ? hidden.length() : 0;
    const std::string cls = row.text("cls");
    if (cls == "touch_x") {  // any valid answer
      EXPECT_TRUE(!hides || (hidden.lo >= 0 && hidden.hi <= 1)) << name;
      continue;
    }
    if (row.integer("occ") == 0 || (cls == "edge_in_plane" && !hides)) {
      errors.check("hides nothing", name, length, 0, kSingle, 64);
      continue;
    }
    ASSERT_TRUE(hides) << name << ": should hide [" << row.text("lo") << ", " << row.text("hi") << "]";
    errors.absolute("lo", name, hidden.lo, row.reference("lo"), (1 + row.number("cond")) * kSingle - 1, 16);
    errors.absolute("hi", name, hidden.hi, row.reference("hi"), (1 + row.number("cond")) * kSingle - 1, 16);
  }
}

TriangleMesh mesh_of(const std::vector<Row>& triangles, const std::string& mesh) {
  TriangleMesh result;
  for (const Row& row : triangles) {
    if (row.text("mesh") != mesh) continue;
    for (const char* corner : {"v0", "v1", "v2"}) {
      result.indices.push_back(static_cast<uint32_t>(result.positions.size()));
      result.positions.push_back(row.vector(corner));
    }
  }
  return result;
}

TEST(Occlusion, UnionOfAMeshIsWatertight) {
  WorstErrors errors("f4b");
  const std::vector<Row> triangles = read_battery("f4b_mesh_triangles");
  for (const Row& row : read_battery("f4b_mesh_expected")) {
    const std::string name = row.text("mesh") + " " + row.text("kind");
    const TriangleMesh mesh = mesh_of(triangles, row.text("mesh"));
    ASSERT_EQ(static_cast<int>(mesh.triangles()), row.integer("ntri")) << name;
    const MeshInput input{&mesh};
    const auto geometry = Geometry::build({&input, 1}, {}, {}, 1);
    ASSERT_TRUE(geometry.ok());
    const LineQuery query{row.vector("x"), row.vector("a"), row.vector("b")};
    std::vector<IntervalSet> visible;
    QueryCounters counters;
    geometry->visible({&query, 1}, visible, counters);
    IntervalSet hidden;
    hidden.reset();
    for (const Interval& i : visible[0]) hidden.subtract(i.lo, i.hi);
    ASSERT_EQ(static_cast<int>(hidden.size()), row.integer("nint")) << name;
    for (size_t i = 0; i < hidden.size(); ++i) {
      const double cond = (1 + row.number("cond")) * kSingle - 1;
      errors.absolute("lo", name, hidden[i].lo, row.reference("lo" + std::to_string(i)), cond, 16);
      errors.absolute("hi", name, hidden[i].hi, row.reference("hi" + std::to_string(i)), cond, 16);
    }
  }
}

}  // namespace
}  // namespace penumbra

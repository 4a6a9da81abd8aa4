// Families f4 and f4b: what one triangle, and the union of a mesh's triangles, hides of a chord. The fan and
// the triangle test are the product's own, in single precision, so eps = 2^-24.
#include <fmt/format.h>

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

LineFan fan_of(const Vec3f& x, const Vec3f& a, const Vec3f& b, const Vec3f p[3]) {
  double reach = 0;
  for (int i = 0; i < 3; ++i) reach = std::max(reach, (Vec3d(p[i]) - Vec3d(x)).length());
  return make_fan(Vec3d(x), Vec3d(a) - Vec3d(x), Vec3d(b) - Vec3d(x), reach);
}

/// One writing of a row: what it hides must not depend on which vertex comes first, which end of the chord is
/// called a, how the axes are named, or on a power of two as the unit of length.
struct Writing {
  int first = 0, second = 1, third = 2;  ///< order of the vertices
  bool swapped = false;                  ///< the chord from b to a
  int axes = 0;                          ///< rotation of the axes
  float unit = 1;

  Vec3f written(const Vec3f& p) const {
    return Vec3f(p[axes % 3], p[(axes + 1) % 3], p[(axes + 2) % 3]) * unit;
  }
  std::string name() const {
    return fmt::format(" ({}{}{}{} axes {} unit {:g})", first, second, third, swapped ? " b-a" : "", axes,
                       unit);
  }
};

std::vector<Writing> writings() {
  std::vector<Writing> all;
  constexpr int kOrders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (const auto& order : kOrders)
    for (const bool swapped : {false, true})
      for (const int axes : {0, 1, 2})
        for (const float unit : {1.f, 0x1p-20f, 0x1p20f})
          all.push_back({order[0], order[1], order[2], swapped, axes, unit});
  return all;
}

void judge(const Row& row, const Writing& writing, WorstErrors& errors) {
  const std::string name = row.label() + writing.name(), cls = row.text("cls");
  const Vec3f v[3] = {writing.written(row.vector("v0")), writing.written(row.vector("v1")),
                      writing.written(row.vector("v2"))};
  const Vec3f p[3] = {v[writing.first], v[writing.second], v[writing.third]};
  Vec3f a = writing.written(row.vector("a")), b = writing.written(row.vector("b"));
  if (writing.swapped) std::swap(a, b);
  const LineFan fan = fan_of(writing.written(row.vector("x")), a, b, p);
  const Interval hidden = fan.degenerate ? kHidesNothing : hidden_by_triangle(fan, p);
  const bool hides = hidden.lo < hidden.hi;
  if (cls == "touch_x") {  // any valid answer
    EXPECT_TRUE(!hides || (hidden.lo >= 0 && hidden.hi <= 1)) << name;
    return;
  }
  if (row.integer("occ") == 0 || (cls == "edge_in_plane" && !hides)) {
    errors.check("hides nothing", name, hides ? hidden.length() : 0, 0, 1, 64);
    return;
  }
  ASSERT_TRUE(hides) << name << ": should hide [" << row.text("lo") << ", " << row.text("hi") << "]";
  const long double lo = row.reference("lo"), hi = row.reference("hi");
  errors.absolute("lo", name, hidden.lo, writing.swapped ? 1 - hi : lo, row.number("cond"), 16);
  errors.absolute("hi", name, hidden.hi, writing.swapped ? 1 - lo : hi, row.number("cond"), 16);
}

TEST(Occlusion, OneTriangleInEveryWriting) {
  WorstErrors errors("f4_occlusion", kFloatRoundoff);
  for (const Row& row : read_battery("f4_visibility_triangle"))
    for (const Writing& writing : writings()) ASSERT_NO_FATAL_FAILURE(judge(row, writing, errors));
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
  WorstErrors errors("f4b_mesh_union", kFloatRoundoff);
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
      const double cond = row.number("cond");
      errors.absolute("lo", name, hidden[i].lo, row.reference("lo" + std::to_string(i)), cond, 16);
      errors.absolute("hi", name, hidden[i].hi, row.reference("hi" + std::to_string(i)), cond, 16);
    }
  }
}

}  // namespace
}  // namespace penumbra

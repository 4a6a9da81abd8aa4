// Line queries over any triangles, from any finite point: every path answers with the scalar reference's
// bits, in order, within [0,1]. What is left after the triangles names the point that is asked about;
// nothing, all.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "proto/status.h"
#include "worker/geometry/line_query.h"

namespace penumbra {
namespace {

/// Floats of the input, one after another: small multiples of 1/16 so that degenerate positions are common,
/// or any finite bits below 2^30.
class Input {
 public:
  Input(const uint8_t* data, size_t size) : data_(data), size_(size) {}
  bool has(size_t bytes) const { return size_ >= bytes; }
  float number() {
    if (size_ < 5) return 0;
    const bool small = data_[0] & 1;
    float value;
    std::memcpy(&value, data_ + 1, sizeof value);
    if (small) value = static_cast<float>(static_cast<int8_t>(data_[1])) / 16;
    data_ += 5;
    size_ -= 5;
    return std::abs(value) < 0x1p30f && (value == 0 || std::abs(value) > 0x1p-30f) ? value : 1.f;
  }
  Vec3f vector() {
    const float x = number(), y = number();
    return {x, y, number()};
  }
  std::optional<size_t> last_byte() const {
    return size_ == 0 ? std::nullopt : std::optional<size_t>(data_[0]);
  }

 private:
  const uint8_t* data_;
  size_t size_;
};

/// A chord in a light's plane through p.
LineQuery with_plane(LineQuery query, const Vec3f& p) {
  const Vec3d normal = (Vec3d(query.b) - Vec3d(query.a)).cross(Vec3d(p) - Vec3d(query.a));
  if (normal.length() > 0) query.plane = {normal.normalized(), kFloatRoundoff * std::abs(double{query.a.x})};
  return query;
}

/// The input's own points as ends of chords and as what sees them: chords through vertices, along edges and
/// in triangles' planes are the common case. Of the first points all are taken, or the one that the input
/// names: then the fuzzer learns what each chord does, and asks six times as many inputs a second.
std::vector<LineQuery> queries_of(const Vec3f& x, const Vec3f& a, const Vec3f& b, const TriangleMesh& mesh,
                                  std::optional<size_t> named) {
  constexpr size_t kMostPoints = 8;
  std::vector<LineQuery> queries{{x, a, b}, {x, b, a}};
  const size_t n = std::min(mesh.positions.size(), kMostPoints);
  for (size_t i = 0; i < n; ++i) {
    if (named && *named % n != i) continue;
    const Vec3f &p = mesh.positions[i], &next = mesh.positions[(i + 1) % n];
    queries.push_back({x, p, next});
    queries.push_back(with_plane({x, a, b}, p));
    queries.push_back({p, a, b});
  }
  return queries;
}

void check(const LineBvh& bvh, const LineQuery& query) {
  std::vector<IntervalSet> expected, got;
  QueryCounters counters;
  visible_lines(bvh, LinePath::kScalar, {&query, 1}, expected, counters);
  float end = 0;
  for (const Interval& i : expected[0]) {
    PENUMBRA_CHECK(end <= i.lo && i.lo < i.hi && i.hi <= 1);
    end = i.hi;
  }
  visible_lines(bvh, LinePath::kAvx2, {&query, 1}, got, counters);
  PENUMBRA_CHECK(got[0] == expected[0]);
  if (widest_line_path() != LinePath::kAvx512) return;
  visible_lines(bvh, LinePath::kAvx512, {&query, 1}, got, counters);
  PENUMBRA_CHECK(got[0] == expected[0]);
}

}  // namespace
}  // namespace penumbra

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace penumbra;
  Input input(data, size);
  const Vec3f x = input.vector(), a = input.vector(), b = input.vector();
  TriangleMesh mesh;
  while (input.has(45)) {
    for (int c = 0; c < 3; ++c) {
      mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(input.vector());
    }
  }
  const MeshInput mesh_input{&mesh};
  const auto bvh = build_line_bvh({&mesh_input, 1}, {}, {}, 1);
  PENUMBRA_CHECK(bvh.ok());
  for (const LineQuery& query : queries_of(x, a, b, mesh, input.last_byte())) check(*bvh, query);
  return 0;
}

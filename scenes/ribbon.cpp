// Ribbons: strips of a curve's width whose normals are given, turning from piece end to piece end.
#include <cmath>
#include <optional>

#include "scenes/curve_chords.h"
#include "scenes/mesh_makers.h"

namespace penumbra {
namespace {

/// From a to b at constant speed on the great circle. Opposite normals have none: pbrt gives an undefined
/// one, here it is the first until the middle.
Vec3d turned(const Vec3d& a, const Vec3d& b, double angle, double t) {
  if (!(std::sin(angle) > 0x1p-26)) return t < 0.5 ? a : b;
  return a * (std::sin((1 - t) * angle) / std::sin(angle)) + b * (std::sin(t * angle) / std::sin(angle));
}

void add_section(TriangleMesh& mesh, const Vec3d& p, const Vec3d& tangent, const Vec3d& normal, double width,
                 double u) {
  const Vec3d across = normal.cross(tangent).normalized() * (0.5 * width);
  const Vec3d upright = tangent.cross(across).normalized();
  for (const double side : {-1., 1.}) {
    mesh.positions.emplace_back(p + across * side);
    mesh.normals.emplace_back(upright);
    mesh.uvs.emplace_back(static_cast<float>(u), side < 0 ? 0.f : 1.f);
  }
}

}  // namespace

/// Texture coordinates (u along, v across), as pbrt has them.
MeshOr make_ribbon(const ShapeEntity& shape, const MeshContext& context) {
  ASSIGN_OR_RETURN(const Curve curve, curve_of(shape, context.description, context.files, context.warnings));
  const double tolerance = kCurveTolerance * std::max(curve.width0, curve.width1);
  TriangleMesh mesh;
  for (size_t k = 0; k < curve.pieces.size(); ++k) {
    const CurvePiece& piece = curve.pieces[k];
    const Vec3d &n0 = curve.normals[k], &n1 = curve.normals[k + 1];
    const double angle = std::atan2(n0.cross(n1).length(), n0.dot(n1));
    const int chords = chords_for_turn(piece, chords_of(piece, tolerance), tolerance);
    const int steps = std::max(chords, static_cast<int>(std::ceil(angle / kMostTurn)));
    for (int i = k == 0 ? 0 : 1; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps, u = (static_cast<double>(k) + t) / curve.pieces.size();
      add_section(mesh, point_at(piece, t), tangent_at(piece, t), turned(n0, n1, angle, t), curve.width(u),
                  u);
      if (i == 0) continue;
      const auto last = static_cast<uint32_t>(mesh.positions.size());
      const uint32_t a = last - 4, b = last - 3, c = last - 2, d = last - 1;
      mesh.indices.insert(mesh.indices.end(), {a, c, d, a, d, b});
    }
  }
  return mesh;
}

}  // namespace penumbra

#pragma once
// pbrt's `Shape "curve"`: cubic pieces with a width, and what is rendered of them. A `ribbon` is a real
// surface: a mesh (make_ribbon). `flat` and `cylinder` hide the same thing, whatever is nearer to the curve
// than half its width, seen from anywhere: tubes. They differ in the normal alone.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "scenes/mesh.h"

namespace penumbra {

/// One cubic Bézier piece.
using CurvePiece = std::array<Vec3d, 4>;

enum class CurveType { kFlat, kCylinder, kRibbon };

/// A curve as it was written, in object space, quadratics and b-splines as cubic Bézier pieces. Its parameter
/// u runs over all pieces from 0 to 1, and the width is linear in it.
struct Curve {
  CurveType type = CurveType::kFlat;
  double width0 = 1, width1 = 1;
  std::vector<CurvePiece> pieces;
  std::vector<Vec3d> normals;  ///< ribbons: unit, at the pieces' ends, one more than pieces

  double width(double u) const { return width0 + u * (width1 - width0); }
};

/// How far a chord may lie from its curve, in widths (the larger of both): pbrt stops at half of this.
constexpr double kCurveTolerance = 0.1;
/// A piece is cut into at most so many segments, whatever the tolerance says, as in pbrt.
constexpr int kMostCurveSegments = 1024;

/// InvalidArgument (`file:line:column: …`) by pbrt's rules: degree, basis, type, number of points and
/// normals.
absl::StatusOr<Curve> curve_of(const ShapeEntity& shape, const SceneDescription& description,
                               const SceneFiles& files, std::vector<std::string>& warnings);

/// Tubes along many curves. Segment i is the convex hull of two balls, with centres and radii
/// points[segments[i]] and the one after it. Bézier pieces become chords within the tolerance.
struct Tubes {
  std::vector<Imath::V4f> points;  ///< centre, radius
  std::vector<float> us;           ///< per point: the curve's parameter
  std::vector<uint32_t> segments;  ///< per segment: its first point
  bool facing = false;             ///< `flat`: the normal is towards the viewer
};

/// Of the curves, those that are tubes, and those that are meshes.
bool has_tubes(const ShapeEntity& shape);
bool has_ribbon(const ShapeEntity& shape);

/// Appends a curve, placed by `to_world`. A transform that is no similarity would make the tube elliptic: it
/// is round, of the same cross-section's area at constant volume (∛|det|); false where that changes more than
/// a thousandth of the width.
bool add_tubes(const Curve& curve, const Matrix& to_world, Tubes& tubes);

}  // namespace penumbra

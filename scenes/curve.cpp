#include "scenes/curve.h"

#include <algorithm>
#include <cmath>

#include "scenes/curve_chords.h"
#include "scenes/mesh_makers.h"

namespace penumbra {
namespace {

Vec3d lerp(const Vec3d& a, const Vec3d& b, double t) {
  return a + (b - a) * t;
}

Vec3d triple(const Param& param, size_t i) {
  return {param.numbers[i], param.numbers[i + 1], param.numbers[i + 2]};
}

/// The cubic of a quadratic's three points.
CurvePiece elevated(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return {a, lerp(a, b, 2 / 3.), lerp(b, c, 1 / 3.), c};
}

/// Piece of a uniform b-spline, by its knots' blossoms.
CurvePiece of_spline(const Vec3d* p, int degree) {
  if (degree == 2) return elevated(lerp(p[0], p[1], 0.5), p[1], lerp(p[1], p[2], 0.5));
  const Vec3d a = lerp(p[0], p[1], 2 / 3.), b = lerp(p[1], p[2], 1 / 3.), c = lerp(p[1], p[2], 2 / 3.),
              d = lerp(p[2], p[3], 1 / 3.);
  return {lerp(a, b, 0.5), b, c, lerp(c, d, 0.5)};
}

CurvePiece of_bezier(const Vec3d* p, int degree) {
  return degree == 2 ? elevated(p[0], p[1], p[2]) : CurvePiece{p[0], p[1], p[2], p[3]};
}

/// Reads one curve; the shape's own place serves where a parameter is missing.
class Reader {
 public:
  Reader(const ShapeEntity& shape, const MeshContext& context) : shape_(shape), context_(context) {}

  absl::StatusOr<Curve> read() {
    RETURN_IF_ERROR(read_type());
    RETURN_IF_ERROR(read_widths());
    RETURN_IF_ERROR(read_pieces());
    RETURN_IF_ERROR(read_normals());
    return curve_;
  }

 private:
  FileLoc place(std::string_view name) const {
    const Param* const param = shape_.params.find(name);
    return param ? param->loc : shape_.loc;
  }

  absl::Status read_type() {
    const std::string type = shape_.params.string("type", "flat");
    if (type == "flat")
      curve_.type = CurveType::kFlat;
    else if (type == "cylinder")
      curve_.type = CurveType::kCylinder;
    else if (type == "ribbon")
      curve_.type = CurveType::kRibbon;
    else
      return context_.error(place("type"), "curve type '{}' is not flat, cylinder or ribbon",
                            printable(type));
    return absl::OkStatus();
  }

  absl::Status read_widths() {
    const double width = shape_.params.number("width", 1);
    curve_.width0 = shape_.params.number("width0", width);
    curve_.width1 = shape_.params.number("width1", width);
    for (const auto& [name, value] : {std::pair("width0", curve_.width0), {"width1", curve_.width1}}) {
      const char* const given = shape_.params.find(name) ? name : "width";
      if (!std::isfinite(value) || value < 0)
        return context_.error(place(given), "a curve's {} of {} is not finite or negative", given, value);
    }
    if (!(std::max(curve_.width0, curve_.width1) > 0))
      return context_.error(place("width"), "a curve without width");
    return absl::OkStatus();
  }

  absl::Status read_pieces() {
    const int64_t degree = shape_.params.integer("degree", 3);
    if (degree != 2 && degree != 3)
      return context_.error(place("degree"), "a curve of degree {}: only 2 and 3 are supported", degree);
    const std::string basis = shape_.params.string("basis", "bezier");
    if (basis != "bezier" && basis != "bspline")
      return context_.error(place("basis"), "curve basis '{}' is not bezier or bspline", printable(basis));
    const bool spline = basis == "bspline";
    const Param* const p = shape_.params.find("P");
    if (!p || p->type != "point3") return context_.error(shape_.loc, "curve without \"point3 P\"");
    if (p->numbers.size() % 3 != 0)
      return context_.error(p->loc, "{} coordinates are no multiple of 3", p->numbers.size());
    for (const double x : p->numbers)
      if (!std::isfinite(x)) return context_.error(p->loc, "a control point of a curve is not finite");
    const auto n = static_cast<int64_t>(p->numbers.size() / 3);
    const int64_t step = spline ? 1 : degree;
    if (n < degree + 1 || (n - 1 - degree) % step != 0)
      return context_.error(
          p->loc, "{} control points: a {} curve of degree {} has {}, n >= 0", n, basis, degree,
          spline ? fmt::format("{} + n", degree + 1) : fmt::format("{} + {} n", degree + 1, degree));
    std::vector<Vec3d> points(static_cast<size_t>(n));
    for (size_t i = 0; i < points.size(); ++i) points[i] = triple(*p, 3 * i);
    for (int64_t i = 0; i + degree < n; i += step)
      curve_.pieces.push_back(spline ? of_spline(&points[static_cast<size_t>(i)], static_cast<int>(degree))
                                     : of_bezier(&points[static_cast<size_t>(i)], static_cast<int>(degree)));
    return absl::OkStatus();
  }

  absl::Status read_normals() {
    const Param* const n = shape_.params.find("N");
    const bool ribbon = curve_.type == CurveType::kRibbon;
    if (!n && ribbon) return context_.error(shape_.loc, "a ribbon needs \"normal N\" at its ends");
    if (!n) return absl::OkStatus();
    if (!ribbon) {
      context_.warn(n->loc, "only ribbons have normals: N is left out");
      return absl::OkStatus();
    }
    if (n->type != "normal" || n->numbers.size() != 3 * (curve_.pieces.size() + 1))
      return context_.error(n->loc, "{} values of N: a ribbon of {} pieces has {} normals", n->numbers.size(),
                            curve_.pieces.size(), curve_.pieces.size() + 1);
    for (size_t i = 0; i < n->numbers.size(); i += 3) {
      const Vec3d normal = triple(*n, i);
      if (!std::isfinite(normal.length2()) || normal.length2() == 0)
        return context_.error(n->loc, "normal {} of a ribbon has no direction", i / 3);
      curve_.normals.push_back(normal.normalized());
    }
    return absl::OkStatus();
  }

  const ShapeEntity& shape_;
  const MeshContext& context_;
  Curve curve_;
};

bool is_ribbon(const ShapeEntity& shape) {
  return shape.params.string("type", "flat") == "ribbon";
}

/// Do lengths change by one factor in all directions, to a thousandth?
bool is_similarity(const Matrix& m) {
  double least = 0, most = 0, skew = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3d row(m[i][0], m[i][1], m[i][2]), next(m[(i + 1) % 3][0], m[(i + 1) % 3][1], m[(i + 1) % 3][2]);
    least = i == 0 ? row.length2() : std::min(least, row.length2());
    most = std::max(most, row.length2());
    skew = std::max(skew, std::abs(row ^ next));
  }
  return most - least <= 2e-3 * most && skew <= 1e-3 * most;
}

}  // namespace

absl::StatusOr<Curve> curve_of(const ShapeEntity& shape, const SceneDescription& description,
                               const SceneFiles& files, std::vector<std::string>& warnings) {
  return Reader(shape, {description, files, warnings}).read();
}

bool has_tubes(const ShapeEntity& shape) {
  return shape.type == "curve" && !is_ribbon(shape);
}

bool has_ribbon(const ShapeEntity& shape) {
  return shape.type == "curve" && is_ribbon(shape);
}

bool add_tubes(const Curve& curve, const Matrix& to_world, Tubes& tubes) {
  const double scale = std::cbrt(std::abs(to_world.determinant()));
  const double tolerance = kCurveTolerance * scale * std::max(curve.width0, curve.width1);
  for (size_t k = 0; k < curve.pieces.size(); ++k) {
    CurvePiece piece;
    for (int i = 0; i < 4; ++i) to_world.multVecMatrix(curve.pieces[k][i], piece[i]);
    const double wider = 0.5 * scale *
                         std::max(curve.width(double(k) / double(curve.pieces.size())),
                                  curve.width(double(k + 1) / double(curve.pieces.size())));
    const int enough = std::max(chords_of(piece, tolerance), chords_for_length(piece, kMostSlender * wider));
    const int chords = chords_for_turn(piece, enough, tolerance);
    for (int i = k == 0 ? 0 : 1; i <= chords; ++i) {
      const double t = static_cast<double>(i) / chords,
                   u = (static_cast<double>(k) + t) / curve.pieces.size();
      const Vec3d p = point_at(piece, t);
      if (i > 0) tubes.segments.push_back(static_cast<uint32_t>(tubes.points.size() - 1));
      tubes.points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z),
                                static_cast<float>(0.5 * scale * curve.width(u)));
      tubes.us.push_back(static_cast<float>(u));
    }
  }
  return is_similarity(to_world);
}

}  // namespace penumbra

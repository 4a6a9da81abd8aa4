#include "worker/lights/window_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "proto/status.h"

namespace penumbra {
namespace {

constexpr double kPi = std::numbers::pi;

/// Cells [first,last) of which a window covers this fraction each.
struct Part {
  int first = 0, last = 0;
  double fraction = 0;
};

/// [lo,hi], in cells, as its first cell, the whole ones and its last: no small part is a difference of large
/// ones.
std::array<Part, 3> parts_of(double lo, double hi, int first, int last) {
  if (first == last) return {Part{first, first + 1, hi - lo}, {}, {}};
  return {Part{first, first + 1, double(first + 1) - lo}, Part{first + 1, last, 1},
          Part{last, last + 1, hi - double(last)}};
}

}  // namespace

Vec2d window_place(const Vec3d& direction) {
  return {std::atan2(direction.x, direction.z) / kPi + 0.5, std::atan2(direction.y, direction.z) / kPi + 0.5};
}

Vec3d window_direction(const Vec2d& place) {
  return {std::tan(kPi * (place.x - 0.5)), std::tan(kPi * (place.y - 0.5)), 1};
}

double window_solid_angle(const Vec3d& d) {
  // dω = dx dy / r³ on the plane z = 1, and dx = (1 + x²) dα; here for a direction of any length.
  const double xz = d.x * d.x + d.z * d.z, yz = d.y * d.y + d.z * d.z, r2 = d.length2();
  return kPi * kPi * (xz / r2) * (yz / r2) * (std::sqrt(r2) / d.z);
}

WindowTable::WindowTable(int width, int height, const std::vector<double>& values)
    : width_(width), height_(height), values_(values) {
  PENUMBRA_CHECK(width > 0 && height > 0 && values.size() == size_t(width) * size_t(height));
  const size_t stride = size_t(width) + 1;
  sums_.assign(stride * (size_t(height) + 1), 0);
  for (int y = 0; y < height; ++y) {
    double row = 0;
    for (int x = 0; x < width; ++x) {
      PENUMBRA_CHECK(value(x, y) > 0);
      row += value(x, y);
      sums_[size_t(y + 1) * stride + size_t(x + 1)] = sums_[size_t(y) * stride + size_t(x + 1)] + row;
    }
  }
}

double WindowTable::block(int x0, int x1, int y0, int y1) const {
  if (x0 >= x1 || y0 >= y1) return 0;
  if (x1 == x0 + 1 && y1 == y0 + 1) return value(x0, y0);
  const size_t stride = size_t(width_) + 1;
  const auto sum = [&](int x, int y) { return sums_[size_t(y) * stride + size_t(x)]; };
  return std::max((sum(x1, y1) - sum(x0, y1)) - (sum(x1, y0) - sum(x0, y0)), 0.0);
}

int WindowTable::cell(int axis, double place) const {
  const int n = axis == 0 ? width_ : height_;
  return std::clamp(int(place * n), 0, n - 1);
}

double WindowTable::integral(const Window& w) const {
  const auto xs = parts_of(w.lo.x * width_, w.hi.x * width_, cell(0, w.lo.x), cell(0, w.hi.x));
  const auto ys = parts_of(w.lo.y * height_, w.hi.y * height_, cell(1, w.lo.y), cell(1, w.hi.y));
  double sum = 0;
  for (const Part& y : ys)
    for (const Part& x : xs)
      if (x.fraction > 0 && y.fraction > 0)
        sum += x.fraction * y.fraction * block(x.first, x.last, y.first, y.last);
  return sum;
}

double WindowTable::place_along(int axis, const Window& window, double integral, double u) const {
  const double n = cells(axis), target = u * integral;
  const int first = cell(axis, window.lo[axis]), last = cell(axis, window.hi[axis]);
  // The last cell before whose edge there is no more than the target.
  const auto before = [&](int edge) {
    Window part = window;
    part.hi[axis] = edge / n;
    return this->integral(part);
  };
  int from = first, beyond = last + 1;
  double below = 0;
  while (from + 1 < beyond) {
    const int middle = from + (beyond - from) / 2;
    const double sum = before(middle);
    if (sum <= target) {
      from = middle;
      below = sum;
    } else {
      beyond = middle;
    }
  }
  Window own = window;
  own.lo[axis] = std::max(window.lo[axis], from / n);
  own.hi[axis] = std::min(window.hi[axis], (from + 1) / n);
  const double whole = this->integral(own);
  const double v = whole > 0 ? std::clamp((target - below) / whole, 0.0, 1.0) : 0;
  return std::clamp(own.lo[axis] + v * (own.hi[axis] - own.lo[axis]), window.lo[axis], window.hi[axis]);
}

Vec2d WindowTable::sample(const Window& window, double integral, const Vec2d& u) const {
  const double x = place_along(0, window, integral, u.x);
  // Of the column of cells at x every part is alike: y is drawn in all that the window has of it.
  const int column = cell(0, x);
  Window own = window;
  own.lo.x = std::max(window.lo.x, double(column) / width_);
  own.hi.x = std::min(window.hi.x, double(column + 1) / width_);
  return {x, place_along(1, own, this->integral(own), u.y)};
}

double WindowTable::pdf(double integral, const Vec2d& place) const {
  return value(cell(0, place.x), cell(1, place.y)) * double(width_) * double(height_) / integral;
}

}  // namespace penumbra

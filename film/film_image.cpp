#include "film/film_image.h"

#include <algorithm>

namespace penumbra {

PixelRect intersect(const PixelRect& a, const PixelRect& b) {
  PixelRect r{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
  r.x1 = std::max(r.x0, r.x1);
  r.y1 = std::max(r.y0, r.y1);
  return r;
}

bool contains(const PixelRect& outer, const PixelRect& inner) {
  return outer.x0 <= inner.x0 && outer.y0 <= inner.y0 && inner.x1 <= outer.x1 && inner.y1 <= outer.y1;
}

}  // namespace penumbra

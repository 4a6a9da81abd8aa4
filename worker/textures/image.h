#pragma once
// An image as a texture, filtered over a footprint.
#include <half.h>

#include <variant>

#include "worker/textures/pyramid.h"

namespace penumbra {

class Image {
 public:
  explicit Image(Texels texels);

  /// Value at texture coordinates; (0,0) is the lower left corner of the image, (1,1) the upper right, as
  /// in pbrt. dst_dx, dst_dy: the footprint's axes in texture coordinates. Grey images give grey.
  Rgb lookup(const Vec2f& st, const Vec2f& dst_dx, const Vec2f& dst_dy, const ImageSampling& sampling) const;

  int width() const;
  int height() const;
  int levels() const;
  size_t bytes() const;

 private:
  /// Half where every value fits (all 8-bit images do), else float.
  std::variant<Pyramid<Imath::half>, Pyramid<float>> pyramid_;
};

}  // namespace penumbra

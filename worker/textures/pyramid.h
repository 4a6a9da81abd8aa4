#pragma once
// The levels of an image, each half as wide and high as the one before, and the filters that read them.
#include <vector>

#include "scenes/math.h"

namespace penumbra {

enum class Wrap { kRepeat, kBlack, kClamp };
enum class Filter { kPoint, kBilinear, kTrilinear, kEwa };

/// How a texture reads an image.
struct ImageSampling {
  Wrap wrap = Wrap::kRepeat;
  Filter filter = Filter::kEwa;
  float max_anisotropy = 8;  ///< kEwa: longest footprint axis over the shortest, >= 1
};

/// Linear values, rows from the top, channels interleaved: 1 (grey) or 3 (RGB).
struct Texels {
  int width = 0, height = 0, channels = 0;
  std::vector<float> values;
};

/// T: how a value is stored, half or float. Coordinates here run from the upper left corner to (1,1).
template <class T>
class Pyramid {
 public:
  Pyramid() = default;
  explicit Pyramid(Texels texels);

  /// Value over the footprint with axes dx and dy about st.
  Rgb lookup(const Vec2f& st, const Vec2f& dx, const Vec2f& dy, const ImageSampling& sampling) const;

  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }
  int levels() const { return static_cast<int>(levels_.size()); }
  size_t bytes() const;

 private:
  struct Level {
    int width, height;
    std::vector<T> values;
  };

  Rgb texel(const Level& level, int x, int y, Wrap wrap) const;
  Rgb bilinear(const Level& level, const Vec2f& st, Wrap wrap) const;
  Rgb trilinear(float width, const Vec2f& st, Wrap wrap) const;
  Rgb ewa(const Vec2f& st, Vec2f major, Vec2f minor, const ImageSampling& sampling) const;
  Rgb ellipse(const Level& level, const Vec2f& st, const Vec2f& axis0, const Vec2f& axis1, Wrap wrap) const;
  float level_of(float width) const;

  int channels_ = 0;
  std::vector<Level> levels_;
};

}  // namespace penumbra

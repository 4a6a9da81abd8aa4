#pragma once
// Pictures to tev (https://github.com/Tom94/tev) over its network protocol: a packet is its length (u32,
// itself included), a kind, and fields; numbers little-endian, texts ended by a zero byte.
#include <map>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "film/film_image.h"

namespace penumbra {

/// "Create an image with these channels", which replaces one of the same name.
std::string tev_create(std::string_view name, int width, int height);
/// "These pixels of one channel": `values` are row-major over `rect`, `stride` floats apart.
std::string tev_update(std::string_view name, std::string_view channel, const PixelRect& rect,
                       const float* values, size_t stride);

/// A connection to a tev that is listening.
class Tev {
 public:
  /// InvalidArgument: not HOST:PORT. Unavailable: nobody listens there.
  static absl::StatusOr<Tev> connect(const std::string& address);
  Tev(Tev&& other) noexcept;
  Tev& operator=(Tev&&) = delete;
  ~Tev();

  /// Shows a picture under a name; one that was shown before under the name is replaced.
  absl::Status show(const std::string& name, const FilmImage& image);

 private:
  explicit Tev(int socket) : socket_(socket) {}
  absl::Status send(std::string_view bytes) const;
  int socket_;
  std::map<std::string, std::pair<int, int>> created_;  ///< sizes of the images that tev has
};

}  // namespace penumbra

#include "client/tev.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>

#include "proto/status.h"

namespace penumbra {
namespace {

enum Kind : char { kUpdateImage = 3, kCreateImage = 4 };
constexpr const char* kChannels[] = {"R", "G", "B"};

class Packet {
 public:
  explicit Packet(Kind kind) : bytes_(sizeof(uint32_t), '\0') {
    bytes_ += kind;
    bytes_ += '\0';  // tev keeps showing what it shows
  }
  Packet& text(std::string_view text) {
    bytes_ += text;
    bytes_ += '\0';
    return *this;
  }
  Packet& number(int32_t value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  Packet& value(float value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  std::string take() {
    const auto size = static_cast<uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &size, sizeof size);
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

}  // namespace

std::string tev_create(std::string_view name, int width, int height) {
  Packet packet(kCreateImage);
  packet.text(name).number(width).number(height).number(static_cast<int32_t>(std::size(kChannels)));
  for (const char* channel : kChannels) packet.text(channel);
  return packet.take();
}

std::string tev_update(std::string_view name, std::string_view channel, const PixelRect& rect,
                       const float* values, size_t stride) {
  Packet packet(kUpdateImage);
  packet.text(name).text(channel);
  packet.number(rect.x0).number(rect.y0).number(rect.width()).number(rect.height());
  for (int64_t i = 0; i < rect.area(); ++i) packet.value(values[static_cast<size_t>(i) * stride]);
  return packet.take();
}

absl::StatusOr<Tev> Tev::connect(const std::string& address) {
  const size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == address.size())
    return invalid_input("--display: '{}' is not of the form HOST:PORT", address);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* raw = nullptr;
  const int code =
      getaddrinfo(address.substr(0, colon).c_str(), address.substr(colon + 1).c_str(), &hints, &raw);
  if (code != 0) return invalid_input("--display {}: {}", address, gai_strerror(code));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> found(raw, freeaddrinfo);
  for (const addrinfo* at = raw; at != nullptr; at = at->ai_next) {
    const int socket = ::socket(at->ai_family, at->ai_socktype | SOCK_CLOEXEC, at->ai_protocol);
    if (socket < 0) continue;
    if (::connect(socket, at->ai_addr, at->ai_addrlen) == 0) return Tev(socket);
    ::close(socket);
  }
  return make_status(absl::StatusCode::kUnavailable, "--display {}: {}", address, std::strerror(errno));
}

Tev::Tev(Tev&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), created_(std::move(other.created_)) {}

Tev::~Tev() {
  if (socket_ >= 0) ::close(socket_);
}

absl::Status Tev::send(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return make_status(absl::StatusCode::kUnavailable, "--display: {}", std::strerror(errno));
    bytes.remove_prefix(static_cast<size_t>(n));
  }
  return absl::OkStatus();
}

absl::Status Tev::show(const std::string& name, const FilmImage& image) {
  const std::pair size(image.width, image.height);
  if (const auto it = created_.find(name); it == created_.end() || it->second != size) {
    RETURN_IF_ERROR(send(tev_create(name, image.width, image.height)));
    created_[name] = size;
  }
  for (size_t c = 0; c < std::size(kChannels); ++c)
    RETURN_IF_ERROR(send(tev_update(name, kChannels[c], image.window, image.rgb.data() + c, 3)));
  return absl::OkStatus();
}

}  // namespace penumbra

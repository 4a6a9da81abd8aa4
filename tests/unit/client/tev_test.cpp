#include "client/tev.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <thread>

namespace penumbra {
namespace {

template <class Number>
Number take(std::string_view& bytes) {
  Number value{};
  if (bytes.size() < sizeof value) {
    ADD_FAILURE() << "a packet ends early";
    return value;
  }
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return value;
}

std::string take_text(std::string_view& bytes) {
  const std::string text(bytes.substr(0, bytes.find('\0')));
  bytes.remove_prefix(text.size() + 1);
  return text;
}

/// Puts packets together as a viewer does.
struct Viewer {
  int width = 0, height = 0;
  std::map<std::string, std::vector<float>> channels;

  void read(std::string_view bytes) {
    while (!bytes.empty()) {
      const auto size = std::string_view(bytes).substr(0, 4);
      std::string_view left = size;
      const auto length = take<uint32_t>(left);
      ASSERT_LE(length, bytes.size());
      packet(bytes.substr(4, length - 4));
      bytes.remove_prefix(length);
    }
  }
  void packet(std::string_view p) {
    const char kind = take<char>(p);
    EXPECT_EQ(take<char>(p), 0) << "no grabbing of the focus";
    EXPECT_EQ(take_text(p), "sa:1/balance");
    if (kind == 4) {
      width = take<int32_t>(p);
      height = take<int32_t>(p);
      const auto count = take<int32_t>(p);
      for (int32_t i = 0; i < count; ++i)
        channels[take_text(p)].assign(static_cast<size_t>(width) * static_cast<size_t>(height), -1);
    } else {
      ASSERT_EQ(kind, 3);
      std::vector<float>& channel = channels.at(take_text(p));
      const auto x0 = take<int32_t>(p), y0 = take<int32_t>(p), w = take<int32_t>(p), h = take<int32_t>(p);
      for (int32_t y = y0; y < y0 + h; ++y)
        for (int32_t x = x0; x < x0 + w; ++x) channel.at(static_cast<size_t>(y * width + x)) = take<float>(p);
    }
    EXPECT_TRUE(p.empty());
  }
};

TEST(Tev, AViewerSeesTheCropWhereItIs) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  ASSERT_EQ(getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  std::string received;
  std::thread viewer([&] {
    const int connection = accept(listener, nullptr, nullptr);
    char buffer[4096];
    for (ssize_t n; (n = read(connection, buffer, sizeof buffer)) > 0;)
      received.append(buffer, static_cast<size_t>(n));
    close(connection);
  });
  FilmImage image;
  image.width = 5;
  image.height = 4;
  image.window = {1, 2, 4, 4};
  for (int i = 0; i < 18; ++i) image.rgb.push_back(static_cast<float>(i));
  {
    auto tev = Tev::connect("127.0.0.1:" + std::to_string(ntohs(address.sin_port)));
    ASSERT_TRUE(tev.ok()) << tev.status();
    ASSERT_TRUE(tev->show("sa:1/balance", image).ok());
    image.rgb[0] = 100;
    ASSERT_TRUE(tev->show("sa:1/balance", image).ok()) << "again: no new image";
  }
  viewer.join();
  close(listener);
  Viewer shown;
  shown.read(received);
  EXPECT_EQ(shown.width, 5);
  EXPECT_EQ(shown.height, 4);
  ASSERT_EQ(shown.channels.size(), 3u);
  EXPECT_EQ(shown.channels["R"][2 * 5 + 1], 100);
  EXPECT_EQ(shown.channels["G"][2 * 5 + 1], 1);
  EXPECT_EQ(shown.channels["B"][3 * 5 + 3], 17);
  EXPECT_EQ(shown.channels["R"][0], -1) << "outside the crop";
}

TEST(Tev, NobodyThere) {
  EXPECT_TRUE(absl::IsInvalidArgument(Tev::connect("nonsense").status()));
  EXPECT_TRUE(absl::IsUnavailable(Tev::connect("127.0.0.1:1").status()));
}

}  // namespace
}  // namespace penumbra

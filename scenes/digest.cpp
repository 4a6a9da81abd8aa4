#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "proto/sha256.h"
#include "proto/status.h"
#include "scenes/bundle.h"

namespace penumbra {
namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

absl::StatusOr<Digest> sha256_file(const std::string& path) {
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  const auto fault = [&path] { return invalid_input("{}: {}", path, std::strerror(errno)); };
  if (!file) return fault();
  Sha256 hash;
  std::string buffer(size_t{1} << 18, '\0');
  while (const size_t n = std::fread(buffer.data(), 1, buffer.size(), file.get()))
    hash.add({buffer.data(), n});
  if (std::ferror(file.get())) return fault();
  return hash.hex();
}

}  // namespace penumbra

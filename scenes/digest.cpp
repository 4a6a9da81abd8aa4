#include <openssl/evp.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "proto/status.h"
#include "scenes/bundle.h"

namespace penumbra {
namespace {

struct FreeContext {
  void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
};

class Hash {
 public:
  Hash() { PENUMBRA_CHECK(EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1); }
  void add(const void* bytes, size_t count) {
    PENUMBRA_CHECK(EVP_DigestUpdate(context_.get(), bytes, count) == 1);
  }
  Digest finish() {
    unsigned char bytes[EVP_MAX_MD_SIZE];
    unsigned int count = 0;
    PENUMBRA_CHECK(EVP_DigestFinal_ex(context_.get(), bytes, &count) == 1);
    constexpr char kHex[] = "0123456789abcdef";
    Digest digest;
    for (unsigned int i = 0; i < count; ++i) {
      digest += kHex[bytes[i] >> 4];
      digest += kHex[bytes[i] & 15];
    }
    return digest;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, FreeContext> context_{EVP_MD_CTX_new()};
};

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

Digest sha256(std::string_view bytes) {
  Hash hash;
  hash.add(bytes.data(), bytes.size());
  return hash.finish();
}

absl::StatusOr<Digest> sha256_file(const std::string& path) {
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  const auto fault = [&path] { return invalid_input("{}: {}", path, std::strerror(errno)); };
  if (!file) return fault();
  Hash hash;
  std::string buffer(size_t{1} << 18, '\0');
  while (const size_t n = std::fread(buffer.data(), 1, buffer.size(), file.get())) hash.add(buffer.data(), n);
  if (std::ferror(file.get())) return fault();
  return hash.finish();
}

}  // namespace penumbra

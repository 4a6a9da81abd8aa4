#include "worker/agent/identity.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstring>
#include <filesystem>
#include <random>
#include <utility>

#include "proto/status.h"

namespace penumbra {
namespace {

/// Version 4 (random), RFC 4122 §4.4.
std::string random_uuid() {
  std::random_device device;
  const auto word = [&] { return (uint64_t{device()} << 32) | device(); };
  const uint64_t high = (word() & ~uint64_t{0xf000}) | 0x4000;
  const uint64_t low = (word() & ~(uint64_t{3} << 62)) | (uint64_t{2} << 62);
  return fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:012x}", high >> 32, (high >> 16) & 0xffff, high & 0xffff,
                     low >> 48, low & 0xffff'ffff'ffffu);
}

std::string host_name() {
  char name[HOST_NAME_MAX + 1] = {};
  return gethostname(name, HOST_NAME_MAX) == 0 ? name : "unknown";
}

std::string instruction_set() {
  if (__builtin_cpu_supports("avx512f")) return "avx512";
  if (__builtin_cpu_supports("avx2")) return "avx2";
  return "sse2";
}

}  // namespace

absl::StatusOr<Slot> Slot::take(const std::string& cache) {
  const std::string folder = cache + "/slots";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return invalid_input("--cache: {}: {}", folder, error.message());
  for (int number = 0;; ++number) {
    const std::string path = fmt::format("{}/{}", folder, number);
    const int lock = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (lock < 0) return invalid_input("--cache: {}: {}", path, std::strerror(errno));
    if (::flock(lock, LOCK_EX | LOCK_NB) == 0) return Slot(number, lock);
    ::close(lock);
  }
}

Slot::Slot(Slot&& other) noexcept : number_(other.number_), lock_(std::exchange(other.lock_, -1)) {}

Slot::~Slot() {
  if (lock_ >= 0) ::close(lock_);
}

WorkerInfo make_worker_info(int threads) {
  return {random_uuid(), host_name(), instruction_set(), threads};
}

double process_cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace penumbra

#include "worker/geometry/aligned.h"

#include <sys/mman.h>

namespace penumbra {

void* allocate_aligned(size_t bytes) {
  constexpr size_t line = 64, huge = size_t{2} << 20;
  const size_t alignment = bytes >= huge ? huge : line;
  const size_t rounded = (bytes + alignment - 1) / alignment * alignment;
  void* p = std::aligned_alloc(alignment, rounded);
  if (p == nullptr) throw std::bad_alloc();
  // Queries jump between nodes: a page per TLB entry of 4 KiB costs more than the node test. Advice only;
  // a system that has no huge pages answers with an error that changes nothing.
  if (alignment == huge) madvise(p, rounded, MADV_HUGEPAGE);
  return p;
}

}  // namespace penumbra

#include "worker/geometry/line_workspace.h"

namespace penumbra {

void LineWorkspace::grow_set() {
  lo.resize(lo.size() + 4 * kWidth);
  hi.resize(lo.size());
}

LineWorkspace& line_workspace(uint32_t depth) {
  thread_local LineWorkspace workspace;
  // Every level leaves at most 16 nodes on the stack, and a whole vector may be written past the end.
  const size_t room = (size_t{depth} + 2) * kWidth;
  if (workspace.stack.size() < room) {
    workspace.stack.resize(room);
    workspace.leaves.resize(room);
  }
  if (workspace.lo.empty()) workspace.grow_set();
  return workspace;
}

}  // namespace penumbra

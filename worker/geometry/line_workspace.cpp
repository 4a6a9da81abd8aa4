#include "worker/geometry/line_workspace.h"

namespace penumbra {

void LineBuffers::grow_set() {
  lo.resize(lo.size() + 4 * kWidth);
  hi.resize(lo.size());
}

LineWorkspace& line_workspace(uint32_t depth) {
  thread_local LineWorkspace workspace;
  // Two nodes are taken and their children pushed: every level leaves at most 32 nodes on the stack. Two
  // walks (instances) hold leaves of two nodes each. A whole vector may be written past the end.
  const size_t room = (2 * size_t{depth} + 2) * kWidth;
  if (workspace.lines[0].stack.size() >= room) return workspace;
  for (LineBuffers& line : workspace.lines) {
    line.stack.resize(room);
    line.leaves.resize(5 * kWidth);
    if (line.lo.empty()) line.grow_set();
  }
  return workspace;
}

}  // namespace penumbra

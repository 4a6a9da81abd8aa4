#include "worker/geometry/pair_block.h"

#include <algorithm>

namespace penumbra {

void PairBlock::copy(int lane, const PairBlock& from, int from_lane) {
  for (int c = 0; c < 4; ++c)
    for (int k = 0; k < 3; ++k) p[c][k][lane] = from.p[c][k][from_lane];
  for (int which = 0; which < 2; ++which) {
    id[which][lane] = from.id[which][from_lane];
    order[which][lane] = from.order[which][from_lane];
  }
}

void PairBlock::keep_one(int lane, int which) {
  if (which == 1) {
    for (int k = 0; k < 3; ++k) p[2][k][lane] = p[3][k][lane];
    id[0][lane] = id[1][lane];
    // Corner 3, both bits, is corner 2 now; 0 and 1 are where they were.
    const int corners = order[1][lane];
    order[0][lane] = static_cast<uint8_t>(corners & ~(corners >> 1 & 0b010101));
  }
  for (int k = 0; k < 3; ++k) p[3][k][lane] = p[0][k][lane];
  id[1][lane] = kNone;
  order[1][lane] = order[0][lane];
}

void PairBlock::finish(int used) {
  lanes = used;
  for (int lane = used; lane < kWidth; ++lane) {
    for (int c = 0; c < 4; ++c)
      for (int k = 0; k < 3; ++k) p[c][k][lane] = p[0][k][0];
    id[0][lane] = id[1][lane] = kNone;
    order[0][lane] = order[1][lane] = 0;
  }
  first_id = kNone, last_id = 0;
  for_each_triangle([&](const std::array<Vec3f, 3>&, uint32_t number) {
    first_id = std::min(first_id, number), last_id = std::max(last_id, number);
  });
}

}  // namespace penumbra

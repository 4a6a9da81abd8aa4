#include "worker/geometry/lower_envelope.h"

#include <algorithm>
#include <limits>

namespace penumbra {
namespace {

/// How far `piece` is behind `item` at v, in 1/k; negative: in front.
double behind(const CutPiece& piece, const CutPiece& item, double v) {
  return piece.inverse_depth(v) - item.inverse_depth(v);
}

/// Where in [lo,hi] the piece is in front of the item: [from,to], empty if from >= to.
void in_front(const CutPiece& piece, const LowerEnvelope::Item& item, double lo, double hi, double& from,
              double& to) {
  from = lo;
  to = hi;
  if (item.label == kNothingThere) return;
  if (piece.beyond != item.piece.beyond) {
    if (piece.beyond) to = from;
    return;
  }
  const double at_lo = behind(piece, item.piece, lo), at_hi = behind(piece, item.piece, hi);
  if (at_lo < 0 && at_hi < 0) return;
  if (at_lo >= 0 && at_hi >= 0) {
    to = from;
    return;
  }
  const double crossing = std::clamp(lo + (hi - lo) * (at_lo / (at_lo - at_hi)), lo, hi);
  (at_lo < 0 ? to : from) = crossing;
}

}  // namespace

void LowerEnvelope::reset() {
  items_.clear();
  items_.push_back({0, 1, {}, kNothingThere});
}

void LowerEnvelope::append(double lo, double hi, const CutPiece& piece, PieceLabel label) {
  if (!(lo < hi)) return;
  // One triangle may have several pieces.
  const auto same = [&](const CutPiece& last) {
    return last.beyond == piece.beyond && last.start == piece.start && last.slope == piece.slope;
  };
  if (!next_.empty() && next_.back().label == label && same(next_.back().piece)) {
    next_.back().hi = hi;
    return;
  }
  next_.push_back({lo, hi, piece, label});
}

void LowerEnvelope::insert(const CutPiece& piece, PieceLabel label) {
  double from = 0, to = 0;
  const auto overtakes = [&](const Item& item) {
    const double lo = std::max(item.lo, piece.lo), hi = std::min(item.hi, piece.hi);
    if (!(lo < hi)) return false;
    in_front(piece, item, lo, hi, from, to);
    return from < to;
  };
  // Most pieces come late and win nothing: walks go from near to far.
  if (std::none_of(items_.begin(), items_.end(), overtakes)) return;
  next_.clear();
  for (const Item& item : items_) {
    if (!overtakes(item)) from = to = item.hi;
    append(item.lo, from, item.piece, item.label);
    append(from, to, piece, label);
    append(to, item.hi, item.piece, item.label);
  }
  items_.swap(next_);
}

bool LowerEnvelope::nearer_than(double k, double lo, double hi) const {
  const bool beyond = !(k > 0);
  const double w = k == 0 ? -std::numeric_limits<double>::infinity() : 1 / k;
  // Along a piece 1/k is linear, so its farthest point is an end.
  return std::all_of(items_.begin(), items_.end(), [&](const Item& item) {
    if (item.hi <= lo || item.lo >= hi) return true;
    if (item.label == kNothingThere || item.piece.beyond != beyond)
      return item.label != kNothingThere && beyond;
    return item.piece.inverse_depth(std::max(lo, item.lo)) <= w &&
           item.piece.inverse_depth(std::min(hi, item.hi)) <= w;
  });
}

}  // namespace penumbra

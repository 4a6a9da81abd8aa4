#pragma once
// The nearest of many segments over [0,1], kept while they come in any order: for what the rays of a bow-tie
// see.
#include <cstdint>
#include <vector>

#include "worker/geometry/bow_tie.h"

namespace penumbra {

/// Whose segment; as it is made: nobody's.
struct PieceLabel {
  uint32_t instance = ~uint32_t{0}, triangle = ~uint32_t{0};
  bool operator==(const PieceLabel&) const = default;
};
constexpr PieceLabel kNothingThere{};

class LowerEnvelope {
 public:
  struct Item {
    double lo, hi;
    CutPiece piece;
    PieceLabel label;
  };

  void reset();
  /// Takes the piece where it is nearer than what was there; crossing pieces are cut where they cross.
  void insert(const CutPiece& piece, PieceLabel label);
  /// Is everything in [lo,hi] nearer than depth k? (k falls along the rays.)
  bool nearer_than(double k, double lo, double hi) const;
  /// Ascending, without gaps from 0 to 1.
  const std::vector<Item>& items() const { return items_; }

 private:
  void append(double lo, double hi, const CutPiece& piece, PieceLabel label);
  std::vector<Item> items_, next_;
};

}  // namespace penumbra

#pragma once
// How the candidates of `auto` compare in each tile, from a few pixels there, around, and in the whole image.
// Pure.
#include <cstddef>
#include <vector>

#include "server/auto_measurements.h"

namespace penumbra {

/// Tiles around tile t, which differ from it in column and row by one at most.
std::vector<size_t> neighbours(size_t t, size_t columns, size_t tiles);

/// What the image says of each candidate: the arithmetic mean, which holds the rare bright samples that the
/// few pixels of a tile have missed. A candidate that is wild somewhere needs strong evidence elsewhere.
std::vector<double> typical(const Table& figures, const std::vector<double>& areas);

/// Figures by which candidates are compared, drawn towards those around and the image's, where a tile's few
/// pixels leave room for these: figure_tk = level_t × ratio_tk × typical_k; levels and ratios are blended,
/// each by itself. `image_ratios`: what the image's part of a candidate's ratio counts as.
Table comparable(const Table& figures, const Table& pixels, const std::vector<double>& image,
                 const std::vector<double>& image_ratios, size_t columns);

/// Figures by which passes are given out: each candidate's own, drawn a little towards those around.
Table smoothed(const Table& figures, const Table& pixels, const std::vector<double>& image, size_t columns);

}  // namespace penumbra

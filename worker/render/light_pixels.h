#pragma once
// The pixels in which the camera may meet a light's surface. A light is some hundred times brighter than what
// it lights, so at its outline one camera ray a pass leaves more error than all shadows of the image
// together: there the emission has rays of its own (tile_renderer.cpp).
#include <vector>

#include "proto/job.h"
#include "worker/render/camera.h"
#include "worker/render/scene.h"

namespace penumbra {

/// For each pixel of the tile, row by row: 1 where the pixel's filter meets the projection of an area light,
/// hidden or not. A pixel that is left out loses accuracy only: what a light closer to the camera's plane
/// than single precision resolves projects to, and everything in scenes of more than kMostProjectedLights
/// lights (their outlines are everywhere).
std::vector<uint8_t> light_pixels(const Scene& scene, const Camera& camera, const PixelRect& tile);

constexpr size_t kMostProjectedLights = 1 << 14;

}  // namespace penumbra

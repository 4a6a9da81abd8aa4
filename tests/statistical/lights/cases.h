#pragma once
// Lights and shading points, easy and hard, that every sampler has to get right.
#include <string>
#include <vector>

#include "worker/lights/shape.h"

namespace penumbra::statistical {

struct Case {
  std::string name;
  LightShape shape;
  Vec3d x;
};

inline std::vector<Case> rectangle_cases() {
  const QuadShape square{{-1, -0.5f, 0}, {2, 0, 0}, {0, 1, 0}};
  const QuadShape sliver{{-1, 0, 0}, {2, 0, 0}, {0, 1e-5f, 0}};
  const QuadShape tilted{{3, 1, 2}, {1, 2, 2}, {2, 1, -2}};
  return {{"above", square, {0.3, 0.1, 1.5}},
          {"aside", square, {-3, 4, 2}},
          {"beside one edge", square, {0.2, 3, 0.7}},
          {"near the middle", square, {0.1, 0.2, 1e-3}},
          {"near an edge, outside", square, {-1.001, 0.1, 1e-3}},
          {"grazing", square, {5, 0.3, 1e-4}},
          {"far", square, {1e4, -2e4, 3e4}},
          {"sliver", sliver, {0.2, 0.3, 1}},
          {"sliver, near", sliver, {0.2, 2e-5, 1e-5}},
          {"tilted", tilted, Vec3d(3, 1, 2) + Vec3d(1, 1, 1) - 2.0 * Vec3d(2, -2, 1)}};
}

inline std::vector<Case> parallelogram_cases() {
  const QuadShape skew{{-1, -0.5f, 0}, {2, 0, 0}, {0.7f, 1, 0}};
  const QuadShape blade{{-1, -0.5f, 0}, {2, 0, 0}, {1.9f, 0.01f, 0}};
  return {{"skew above", skew, {0.3, 0.1, 1}},
          {"skew aside", skew, {4, -3, 1}},
          {"skew near", skew, {0, 0, 0.01}},
          {"blade", blade, {0.3, 0.1, 0.5}}};
}

inline std::vector<Case> triangle_cases() {
  const TriangleShape plain{{0, 0, 0}, {2, 0, 0}, {0.5f, 1, 0}};
  const TriangleShape sliver{{0, 0, 0}, {2, 0, 0}, {1, 1e-5f, 0}};
  const TriangleShape needle{{0, 0, 0}, {1e-5f, 0, 0}, {1, 3, 0}};
  return {{"above", plain, {0.8, 0.3, 1}},
          {"aside", plain, {-3, 4, 2}},
          {"near the middle", plain, {0.8, 0.3, 1e-3}},
          {"near an edge", plain, {1, -1e-3, 1e-3}},
          {"near a corner", plain, {-1e-3, 0, 1e-3}},
          {"grazing", plain, {5, 0.3, 1e-4}},
          {"far", plain, {1e4, -2e4, 3e4}},
          {"sliver", sliver, {0.2, 0.3, 1}},
          {"needle", needle, {0.2, 0.3, 1}},
          {"needle, near", needle, {0.3, 1, 1e-4}}};
}

inline std::vector<Case> sphere_cases() {
  const SphereShape ball{{1, 2, 3}, 0.5f, false}, shell{{1, 2, 3}, 0.5f, true};
  return {{"outside", ball, {3, 2, 1}},
          {"all but touching", ball, Vec3d(1, 2, 3) + 0.50001 * Vec3d(0.6, 0, 0.8)},
          {"far", ball, {1e5, 2e4, -3e4}},
          {"inside, off centre", shell, {1.3, 2.1, 3.1}},
          {"inside, at the centre", shell, {1, 2, 3}},
          {"inside, all but touching", shell, Vec3d(1, 2, 3) + 0.4999 * Vec3d(0, -0.6, 0.8)}};
}

/// Shapes that have area sampling only.
inline std::vector<Case> area_cases() {
  const DiskShape disk{{0, 0, 1}, {0, 0.6f, 0.8f}, 2, 0}, annulus{{0, 0, 1}, {0, 0.6f, 0.8f}, 2, 1.5f};
  const CylinderShape tube{{0, 0, 0}, {0, 1, 2}, 0.5f, false}, pipe{{0, 0, 0}, {0, 1, 2}, 0.5f, true};
  return {{"disk", disk, {0.5, 2, 3}},
          {"annulus", annulus, {1, 1, 4}},
          {"cylinder", tube, {2, 1, 1}},
          {"cylinder from inside", pipe, {0.1, 0.5, 1}}};
}

inline std::vector<Case> concatenated(std::initializer_list<std::vector<Case>> lists) {
  std::vector<Case> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

}  // namespace penumbra::statistical

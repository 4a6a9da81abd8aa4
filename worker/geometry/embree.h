#pragma once
// Embree, for the few files that speak to it: the only place that includes it, and who owns what it gives.
#include <embree3/rtcore.h>

#include <memory>
#include <string>

namespace penumbra {

struct EmbreeRelease {
  void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
  void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometryTy* geometry) const { rtcReleaseGeometry(geometry); }
  void operator()(RTCBVHTy* bvh) const { rtcReleaseBVH(bvh); }
};
using DeviceHandle = std::unique_ptr<RTCDeviceTy, EmbreeRelease>;
using SceneHandle = std::unique_ptr<RTCSceneTy, EmbreeRelease>;
using GeometryHandle = std::unique_ptr<RTCGeometryTy, EmbreeRelease>;
using BvhHandle = std::unique_ptr<RTCBVHTy, EmbreeRelease>;

/// Null if Embree gives none.
inline DeviceHandle make_device(int threads) {
  return DeviceHandle(rtcNewDevice(("threads=" + std::to_string(threads)).c_str()));
}

}  // namespace penumbra

#pragma once
#include "worker/agent/scene_loader.h"

namespace penumbra {

/// penumbra-worker from its command line to its exit code: flags, cache, identity, signals. The renderer is
/// the caller's.
int run_worker(int argc, char** argv, const SceneLoader& loader);

}  // namespace penumbra

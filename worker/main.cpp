// penumbra-worker: the agent with the renderer.
#include "worker/agent/program.h"
#include "worker/renderer_loader.h"

int main(int argc, char** argv) { return penumbra::run_worker(argc, argv, penumbra::RendererLoader()); }

#include "client/commands.h"
namespace penumbra {
void add_inspect(CLI::App&, Chosen&) {}
}  // namespace penumbra

#pragma once

namespace penumbra {

/// Debian's abseil is built with a search for lock cycles that gRPC pays for at every lock: no more, in this
/// process. Called before anything of gRPC by open_channel() and by whoever listens.
void ignore_lock_order();

}  // namespace penumbra

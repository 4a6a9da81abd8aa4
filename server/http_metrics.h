#pragma once
#include <string>

#include "server/http_snapshot.h"

namespace penumbra {

/// The snapshot in Prometheus' text format. Every metric is named and explained in server/README.md.
std::string metrics_text(const Snapshot& snapshot);

}  // namespace penumbra

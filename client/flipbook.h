#pragma once
// When light arrives, as a flip-book for the report's page.
#include <optional>
#include <vector>

#include "client/job_json.h"
#include "film/exr.h"

namespace penumbra {

/// {"t0","t1","bins","scale","width","height","mixes":[{"frames":[PNG…]}|null…]}: a picture (base64 of a PNG)
/// per bin of each mix that has bins, all with one exposure; means of scale × scale pixels, so that all
/// frames together have at most 2^22. Null if no mix has bins.
Json flipbook_json(const std::vector<std::optional<ExrBins>>& mixes);

}  // namespace penumbra

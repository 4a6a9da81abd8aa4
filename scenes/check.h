#pragma once
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "scenes/description.h"
#include "scenes/files.h"

namespace penumbra {

/// What a client can know before it starts anything: every mesh is there and can be what its header says,
/// shapes written out in the text make sense (indices, sizes), quadrics have a surface, hair is possible.
/// Reads no more than the beginning of a mesh file; make_mesh reads the rest. InvalidArgument,
/// `file:line:column: …`.
absl::Status check_files(const SceneDescription& description, const SceneFiles& files);

}  // namespace penumbra

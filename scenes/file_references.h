#pragma once
#include <string>
#include <vector>

#include "scenes/description.h"

namespace penumbra {

/// A file that a scene's text names outside of Include and Import.
struct FileReference {
  std::string name;
  FileLoc loc;
  bool required = false;  ///< a mesh: without it there is no scene; images and spectra have substitutes
};

/// Every mesh, image, spectrum, lens and measured material; not what the film writes. A name that stands
/// for one of pbrt's own spectra ("metal-Cu-eta") is listed too: it simply is no file.
std::vector<FileReference> file_references(const SceneDescription& description);

}  // namespace penumbra

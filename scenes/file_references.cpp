#include "scenes/file_references.h"

#include <algorithm>
#include <iterator>

#include "scenes/each_params.h"

namespace penumbra {
namespace {

constexpr std::string_view kFileParameters[] = {"filename", "mapname",   "lensfile",        "bsdffile",
                                                "aperture", "normalmap", "emissionfilename"};

bool names_file(const Param& param) {
  if (param.type == "spectrum") return !param.strings.empty();
  return param.type == "string" && std::find(std::begin(kFileParameters), std::end(kFileParameters),
                                             param.name) != std::end(kFileParameters);
}

}  // namespace

std::vector<FileReference> file_references(const SceneDescription& description) {
  std::vector<FileReference> references;
  const auto collect = [&references](const std::string& owner, const Params& params) {
    for (const Param& param : params.all)
      if (names_file(param))
        for (const std::string& name : param.strings)
          references.push_back({name, param.loc, owner == "plymesh" && param.name == "filename"});
  };
  each_params(description, collect);
  collect(description.camera.type, description.camera.params);
  for (const MediumEntity& medium : description.media) collect(medium.type, medium.params);
  return references;
}

}  // namespace penumbra

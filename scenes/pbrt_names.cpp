#include "scenes/pbrt_names.h"

#include <span>

namespace penumbra {
namespace {

struct Name {
  std::string_view text;
  Support support;
};

constexpr Support kYes = Support::kRendered;
constexpr Support kNo = Support::kSubstituted;

constexpr Name kShapes[] = {
    {"trianglemesh", kYes},
    {"plymesh", kYes},
    {"quad", kYes},
    {"bilinearmesh", kYes},
    {"sphere", kYes},
    {"disk", kYes},
    {"cylinder", kYes},
    {"loopsubdiv", kYes},
    {"curve", kYes},
    {"cone", kNo},
    {"heightfield", kNo},
    {"hyperboloid", kNo},
    {"nurbs", kNo},
    {"paraboloid", kNo},
    // The hair primitive of the pbrt-v2 offshoots that preceded v3's curve; scenes with it circulate.
    {"hair", kNo}};

constexpr Name kLights[] = {{"point", kYes},    {"spot", kYes},       {"distant", kYes},
                            {"infinite", kYes}, {"exinfinite", kYes}, {"goniometric", kNo},
                            {"projection", kNo}};

constexpr Name kAreaLights[] = {{"diffuse", kYes}, {"area", kYes}};

constexpr Name kMaterials[] = {{"", kYes},
                               {"none", kYes},
                               {"interface", kYes},
                               {"matte", kYes},
                               {"diffuse", kYes},
                               {"plastic", kYes},
                               {"coateddiffuse", kYes},
                               {"metal", kYes},
                               {"conductor", kYes},
                               {"substrate", kYes},
                               {"uber", kYes},
                               {"mirror", kYes},
                               {"glass", kYes},
                               {"dielectric", kYes},
                               {"thindielectric", kNo},
                               {"translucent", kYes},
                               {"mix", kYes},
                               {"coatedconductor", kNo},
                               {"diffusetransmission", kNo},
                               {"disney", kNo},
                               {"fourier", kNo},
                               {"measured", kNo},
                               {"hair", kYes},
                               {"subsurface", kNo},
                               {"kdsubsurface", kNo}};

constexpr Name kTextures[] = {
    {"constant", kYes}, {"scale", kYes},       {"mix", kYes},  {"imagemap", kYes}, {"checkerboard", kYes},
    {"bilerp", kNo},    {"directionmix", kNo}, {"dots", kNo},  {"fbm", kNo},       {"marble", kNo},
    {"ptex", kNo},      {"uv", kNo},           {"windy", kNo}, {"wrinkled", kNo}};

constexpr Name kCameras[] = {{"perspective", kYes},
                             {"orthographic", kNo},
                             {"environment", kNo},
                             {"spherical", kNo},
                             {"realistic", kNo}};

// What a film stores and how an accelerator is built is ours to decide; every name of pbrt's will do.
constexpr Name kFilms[] = {{"image", kYes}, {"rgb", kYes}, {"gbuffer", kYes}, {"spectral", kYes}};

constexpr Name kAccelerators[] = {{"bvh", kYes}, {"kdtree", kYes}, {"grid", kYes}};

constexpr Name kSamplers[] = {{"independent", kYes}, {"random", kYes},    {"stratified", kYes},
                              {"sobol", kYes},       {"zsobol", kYes},    {"paddedsobol", kYes},
                              {"halton", kNo},       {"02sequence", kNo}, {"lowdiscrepancy", kNo},
                              {"maxmindist", kNo},   {"pmj02bn", kNo}};

constexpr Name kFilters[] = {
    {"box", kYes}, {"triangle", kYes}, {"gaussian", kYes}, {"mitchell", kYes}, {"sinc", kNo}};

constexpr Name kIntegrators[] = {{"pointline", kYes},
                                 {"directlighting", kYes},
                                 {"path", kYes},
                                 {"simplepath", kYes},
                                 {"whitted", kYes},
                                 {"volpath", kYes},
                                 {"simplevolpath", kYes},
                                 {"ambientocclusion", kNo},
                                 {"ao", kNo},
                                 {"bdpt", kNo},
                                 {"mlt", kNo},
                                 {"sppm", kNo},
                                 {"lightpath", kNo},
                                 {"randomwalk", kNo},
                                 {"function", kNo}};

constexpr Name kMedia[] = {{"homogeneous", kNo}, {"heterogeneous", kNo}, {"uniformgrid", kNo},
                           {"rgbgrid", kNo},     {"cloud", kNo},         {"nanovdb", kNo}};

std::span<const Name> names_of(PluginKind kind) {
  switch (kind) {
    case PluginKind::kShape:
      return kShapes;
    case PluginKind::kLight:
      return kLights;
    case PluginKind::kAreaLight:
      return kAreaLights;
    case PluginKind::kMaterial:
      return kMaterials;
    case PluginKind::kTexture:
      return kTextures;
    case PluginKind::kCamera:
      return kCameras;
    case PluginKind::kFilm:
      return kFilms;
    case PluginKind::kSampler:
      return kSamplers;
    case PluginKind::kFilter:
      return kFilters;
    case PluginKind::kIntegrator:
      return kIntegrators;
    case PluginKind::kAccelerator:
      return kAccelerators;
    case PluginKind::kMedium:
      return kMedia;
  }
  return {};
}

}  // namespace

Support support_of(PluginKind kind, std::string_view name) {
  for (const Name& known : names_of(kind))
    if (known.text == name) return known.support;
  return Support::kUnknown;
}

std::string_view noun(PluginKind kind) {
  switch (kind) {
    case PluginKind::kShape:
      return "shape";
    case PluginKind::kLight:
      return "light source";
    case PluginKind::kAreaLight:
      return "area light source";
    case PluginKind::kMaterial:
      return "material";
    case PluginKind::kTexture:
      return "texture";
    case PluginKind::kCamera:
      return "camera";
    case PluginKind::kFilm:
      return "film";
    case PluginKind::kSampler:
      return "sampler";
    case PluginKind::kFilter:
      return "pixel filter";
    case PluginKind::kIntegrator:
      return "integrator";
    case PluginKind::kAccelerator:
      return "accelerator";
    case PluginKind::kMedium:
      return "medium";
  }
  return "plugin";
}

}  // namespace penumbra

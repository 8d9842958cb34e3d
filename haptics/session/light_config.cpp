#include "haptics/session/light_config.hpp"

#include "engine/cloud/estimated_normals.hpp"
#include "engine/cloud/gaussian_records.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

namespace {

constexpr Setting<LightConfig> kLight[]{
    {"splats", words<&LightConfig::gaussians, kSplatChoices>(), "--splats",
     "how a splat scene is drawn: gaussians (as it was trained), surface (a disc for each point that is felt), or auto "
     "(gaussians); other colours than rgb are always of the surface"},
    {"material", words<&LightConfig::material, kMaterialChoices>(), "--material",
     "surface of the model: clay (soft highlights), stone (rough), plaster (white, soft shadows), metal (reflections), "
     "unlit (the colours as they are), water (points are particles that fill a volume: what is behind is seen through "
     "them), or auto (water for a scene of it, unlit for a file with colours and without normals, else clay)"},
    {"occlusion", words<&LightConfig::occlusion, kSwitchChoices>(), "--occlusion",
     "darken hollows by the share of the sky that is hidden there: on, off, or auto (off on software drivers)"},
    {"cavity", words<&LightConfig::cavity, kSwitchChoices>(), "--cavity",
     "darken grooves and brighten ridges, wherever the light is: on, off, or auto (off on software drivers)"},
    {"ground", words<&LightConfig::ground, kSwitchChoices>(), "--ground",
     "draw the soft shadow on a ground below the model, which is not felt: on, off, or auto (off on software drivers)"},
    {"eye_dome", words<&LightConfig::eyeDome, kSwitchChoices>(), "--eye-dome",
     "darken what lies behind what is beside it, without normals: on, off, or auto (on for bare points, off on "
     "software drivers, and where auto makes the material unlit)"},
    {"backs", words<&LightConfig::hidesBacks, kBackChoices>(), "--backs",
     "surfaces seen from their back: shown, hidden, or auto (hidden in a room that was scanned from inside, so that "
     "one "
     "looks into it through its walls and ceiling)"},
};

}  // namespace

std::span<const Setting<LightConfig>> settingsOf(const LightConfig*) { return kLight; }

Light lightOf(const LightConfig& config, const Model& model, const LightFor& picture) {
  const bool isBareScan =
      picture.ownColors && model.as<StillPoints>() && model.cloud.hasColors() && areNormalsEstimated(model.cloud);
  const bool isWater = model.fluid() && model.fluid()->isWater && !picture.barePoints;
  const Material found = isWater ? Material::water : isBareScan ? Material::unlit : Material::clay;
  const Material material = config.material.value_or(found);
  const bool isUnlit = material == Material::unlit;
  const bool isShaped = !picture.isSoftware && !isUnlit && !picture.barePoints;
  const bool foundUnlit = isUnlit && !config.material;
  return {.material = material,
          .occlusion = config.occlusion.value_or(isShaped),
          .cavity = config.cavity.value_or(isShaped),
          .ground = config.ground.value_or(!picture.isSoftware),
          .eyeDome = config.eyeDome.value_or(foundUnlit || (picture.barePoints && !picture.isSoftware))};
}

bool drawsGaussians(const std::optional<bool>& chosen, const PointCloud& cloud, bool barePoints) {
  return gaussiansOf(cloud) && chosen.value_or(!barePoints);
}

void requireGaussians(const std::optional<bool>& chosen, const PointCloud& cloud, std::string_view option) {
  if (chosen == true && !gaussiansOf(cloud))
    throw UsageError("{}: the model contains no Gaussians; choose surface or auto", option);
}

}  // namespace palpate

// Settings of how a picture draws and lights the model. Independent of Vulkan.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "engine/core/setting.hpp"
#include "engine/render/frame_options.hpp"

namespace palpate {

struct Model;

inline constexpr std::array<std::pair<std::string_view, std::optional<Material>>, 7> kMaterialChoices{
    {{"auto", std::nullopt},
     {"clay", Material::clay},
     {"stone", Material::stone},
     {"plaster", Material::plaster},
     {"metal", Material::metal},
     {"unlit", Material::unlit},
     {"water", Material::water}}};
inline constexpr std::array<std::pair<std::string_view, std::optional<bool>>, 3> kSwitchChoices{
    {{"auto", std::nullopt}, {"on", true}, {"off", false}}};
inline constexpr std::array<std::pair<std::string_view, std::optional<bool>>, 3> kSplatChoices{
    {{"auto", std::nullopt}, {"gaussians", true}, {"surface", false}}};
inline constexpr std::array<std::pair<std::string_view, std::optional<bool>>, 3> kBackChoices{
    {{"auto", std::nullopt}, {"hidden", true}, {"shown", false}}};

/// Empty: automatic (lightOf(), drawsGaussians()).
struct LightConfig {
  std::optional<Material> material;
  std::optional<bool> occlusion, cavity, ground, eyeDome;
  std::optional<bool> gaussians;   ///< of a file that has them; else its surface
  std::optional<bool> hidesBacks;  ///< what is seen from its back is not drawn

  bool operator==(const LightConfig&) const = default;
};
std::span<const Setting<LightConfig>> settingsOf(const LightConfig*);

/// What a picture is drawn by and of, for what is automatic.
struct LightFor {
  bool isSoftware = false;  ///< a driver that draws on the CPU
  bool barePoints = false;  ///< points are drawn without discs
  bool ownColors = true;    ///< the colours of the file are shown, if it has any
};
/// The same rule for the window, its saved pictures and the command line. Material: water for the particles of water
/// unless they are drawn as bare points, unlit if the file has colours and its normals are estimates, else clay. The
/// others: on unless the driver is software, which would be too slow; of unlit colours, only the ground. Eye-dome
/// light: for what has no other light: on for such colours, and for bare points unless the driver is software.
Light lightOf(const LightConfig& config, const Model& model, const LightFor& picture);

/// For FrameOptions::gaussians: auto draws them if the file has them and points with discs are drawn.
bool drawsGaussians(const std::optional<bool>& chosen, const PointCloud& cloud, bool barePoints = false);
/// Throws UsageError, which begins with `option`, if Gaussians are chosen for a cloud without Gaussians.
void requireGaussians(const std::optional<bool>& chosen, const PointCloud& cloud, std::string_view option);

}  // namespace palpate

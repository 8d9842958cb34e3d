// Names and paths that differ between systems.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "haptics/devices/driver_survey.hpp"

namespace palpate {

/// File names of the vendors' libraries, in the order in which they are tried; "" is the program itself.
std::span<const std::string_view> openHapticsNames();
std::span<const std::string_view> forceDimensionNames();

/// Where the driver of 3D Systems stores the results of its setup program.
struct TouchConfiguration {
  std::vector<std::filesystem::path> folders;  ///< candidates
  std::string_view inWords;
};
TouchConfiguration touchConfiguration();

/// The user's folder for the settings of programs: $XDG_CONFIG_HOME or ~/.config, on Windows %APPDATA%; empty if it is
/// unknown.
std::filesystem::path userConfiguration();

/// The configuration file of the service of Haply devices; it exists only if a setting was changed.
std::filesystem::path haplyConfiguration();
/// How a user starts that service.
std::string_view haplyStart();

}  // namespace palpate

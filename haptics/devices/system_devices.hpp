// What has another name, or another place, on each system.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "haptics/devices/driver_survey.hpp"

namespace palpate {

/// What the vendors' libraries are called, in the order in which they are tried; "" is the program itself.
std::span<const std::string_view> openHapticsNames();
std::span<const std::string_view> forceDimensionNames();

/// Where the driver of 3D Systems keeps what its setup program found.
struct TouchConfiguration {
  std::vector<std::filesystem::path> folders;  ///< one of them
  std::string_view inWords;
};
TouchConfiguration touchConfiguration();

}  // namespace palpate

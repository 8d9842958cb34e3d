#include "haptics/devices/system_devices.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace palpate {

namespace fs = std::filesystem;

std::span<const std::string_view> openHapticsNames() {
  static constexpr std::array<std::string_view, 4> kNames{"libHD.so.3.4", "libHD.so", "libHD.so.3.0", ""};
  return kNames;
}

std::span<const std::string_view> forceDimensionNames() {
  static constexpr std::array<std::string_view, 5> kNames{"libdhd.so.3", "libdhd.so", "libdrd.so.3", "libdrd.so", ""};
  return kNames;
}

TouchConfiguration touchConfiguration() {
  TouchConfiguration found{.folders = {}, .inWords = "$GTDD_HOME/config or ~/.3dsystems/config"};
  const char* own = std::getenv("GTDD_HOME");
  const char* home = std::getenv("HOME");
  if (own)
    found.folders.push_back(fs::path(own) / "config");
  else if (home)
    found.folders.push_back(fs::path(home) / ".3dsystems" / "config");
  return found;
}

fs::path userConfiguration() {
  if (const char* own = std::getenv("XDG_CONFIG_HOME"); own && *own) return own;
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".config";
  return {};
}

fs::path haplyConfiguration() { return "/etc/haply-inverse-service/haply-inverse-service-config.json"; }

std::string_view haplyStart() { return "sudo systemctl start haply-inverse-service, or the Haply Hub"; }

std::vector<NodeFinding> surveySerialPorts() {
  std::vector<NodeFinding> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/dev", ignored)) {
    if (!entry.path().filename().string().starts_with("ttyACM")) continue;
    NodeFinding node{.path = entry.path(), .what = "a serial port over USB; a Touch may be behind it"};
    node.usable = ::access(node.path.c_str(), R_OK | W_OK) == 0;
    if (!node.usable) node.mend = "sudo usermod -aG dialout \"$USER\"   # then log in again";
    found.push_back(std::move(node));
  }
  std::ranges::sort(found, {}, &NodeFinding::path);
  return found;
}

}  // namespace palpate

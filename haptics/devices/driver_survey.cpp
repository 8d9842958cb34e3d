#include "haptics/devices/driver_survey.hpp"

#include <unistd.h>

#include <algorithm>
#include <clocale>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "engine/core/error.hpp"
#include "haptics/devices/dhd.hpp"
#include "haptics/devices/force_dimension_device.hpp"
#include "haptics/devices/openhaptics_device.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// `open` gives the facts and limits of the first device.
template <typename Api, typename Open>
DriverFinding survey(const char* option, const LibrarySearch& search, Open&& open) {
  DriverFinding finding{.option = option, .product = std::string(search.product)};
  const VendorLibrary library(search);
  finding.file = library.file();
  finding.attempts = library.attempts();
  if (!library.isLoaded()) {
    finding.problem = library.whyNot();
    return finding;
  }
  finding.missing = Api::missingFrom(library);
  try {
    open(finding);
  } catch (const Error& error) {
    finding.problem = error.what();
  }
  return finding;
}

/// Where the driver of 3D Systems keeps what its setup program found.
bool hasTouchConfiguration() {
  if (const char* home = std::getenv("GTDD_HOME")) return fs::exists(fs::path(home) / "config");
  const char* home = std::getenv("HOME");
  return home && fs::exists(fs::path(home) / ".3dsystems" / "config");
}

}  // namespace

DriverFinding surveyOpenHaptics() {
  return survey<hdapi::Api>("openhaptics", hdapi::librarySearch(), [](DriverFinding& finding) {
    const OpenHapticsDevice device({.calibrationPatience_s = 0});
    finding.device = device.facts();
    finding.limits = device.limits();
  });
}

DriverFinding surveyForceDimension() {
  return survey<dhd::Api>("dhd", dhd::librarySearch(), [](DriverFinding& finding) {
    const ForceDimensionDevice device;
    finding.device = device.facts();
    finding.limits = device.limits();
  });
}

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

std::vector<std::string> surveySurroundings() {
  std::vector<std::string> troubles;
  const VendorLibrary library(hdapi::librarySearch());
  if (library.isLoaded() && !hasTouchConfiguration())
    troubles.emplace_back(
        "the driver of 3D Systems has no configuration ($GTDD_HOME/config or ~/.3dsystems/config); run its setup "
        "program (Touch_Setup)");
  // The driver sets the locale of the environment and then reads its own files, which have decimal points.
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  if (std::setlocale(LC_NUMERIC, "") && std::strcmp(std::localeconv()->decimal_point, ".") != 0)
    troubles.emplace_back(
        "LC_NUMERIC has a decimal comma, with which the driver of 3D Systems misreads its own files; export "
        "LC_NUMERIC=C");
  std::setlocale(LC_NUMERIC, before.c_str());
  return troubles;
}

}  // namespace palpate

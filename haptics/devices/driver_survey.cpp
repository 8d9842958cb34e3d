#include "haptics/devices/driver_survey.hpp"

#include <algorithm>
#include <clocale>
#include <cstring>
#include <filesystem>

#include "engine/core/error.hpp"
#include "haptics/devices/dhd.hpp"
#include "haptics/devices/force_dimension_device.hpp"
#include "haptics/devices/haply_service.hpp"
#include "haptics/devices/openhaptics_device.hpp"
#include "haptics/devices/system_devices.hpp"

namespace palpate {
namespace {

/// `open` sets the facts and limits of the first device.
template <typename Api, typename Open>
DriverFinding survey(const LibrarySearch& search, Open&& open) {
  DriverFinding finding{.product = std::string(search.product)};
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

}  // namespace

DriverFinding surveyOpenHaptics() {
  DriverFinding found = survey<hdapi::Api>(hdapi::librarySearch(), [](DriverFinding& finding) {
    const OpenHapticsDevice device({.calibrationPatience_s = 0});
    finding.device = device.facts();
    finding.limits = device.limits();
  });
  found.nodes = surveySerialPorts();
  return found;
}

DriverFinding surveyForceDimension() {
  return survey<dhd::Api>(dhd::librarySearch(), [](DriverFinding& finding) {
    const ForceDimensionDevice device;
    finding.device = device.facts();
    finding.limits = device.limits();
  });
}

HaplyFinding surveyHaply() {
  HaplyFinding finding;
  try {
    finding.port = haply::servicePorts().simulation;
    HaplyService service;
    finding.version = service.version;
    finding.tellsEvents = service.events != nullptr;
    finding.inventory = std::move(service.inventory);
  } catch (const Error& error) {
    finding.problem = error.what();
  }
  return finding;
}

std::string readinessOf(const haply::Inverse& inverse) {
  if (inverse.inUse) return fmt::format("is used by another program; haply:{}:shared adds to its forces", inverse.id);
  return std::string(meaningOf(!inverse.powered      ? haply::Trouble::noPower
                               : !inverse.calibrated ? haply::Trouble::notCalibrated
                                                     : haply::Trouble::none));
}

std::vector<std::string> surveySurroundings() {
  std::vector<std::string> troubles;
  const VendorLibrary library(hdapi::librarySearch());
  const TouchConfiguration configuration = touchConfiguration();
  const auto exists = [](const std::filesystem::path& folder) { return std::filesystem::exists(folder); };
  if (library.isLoaded() && std::ranges::none_of(configuration.folders, exists))
    troubles.push_back(
        fmt::format("the driver of 3D Systems has no configuration ({}); run its setup program (Touch_Setup)",
                    configuration.inWords));
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

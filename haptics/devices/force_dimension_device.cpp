#include "haptics/devices/force_dimension_device.hpp"

#include <algorithm>
#include <cstring>

#include "engine/core/error.hpp"

namespace palpate {
namespace {

constexpr double kMm_per_metre = 1000;
constexpr unsigned char kWatchdog_ms = 20;

/// Per device: its force limits, and half the edge of a cube within its reach.
struct DhdModel {
  std::string_view name;
  double peak_N, continuous_N, reach_mm;
};
constexpr DhdModel kDhdModels[]{
    {"omega", 12, 12, 55},  {"delta", 20, 20, 130}, {"sigma", 20, 20, 70},
    {"lambda", 20, 20, 70}, {"alcon", 8, 8, 50},    {"", 8, 8, 50},
};

VendorLibrary loadedDhd() {
  VendorLibrary library(dhd::librarySearch());
  if (!library.isLoaded()) throw Error("dhd: {}", library.whyNot());
  return library;
}

}  // namespace

ForceDimensionDevice::ForceDimensionDevice(int index) : library_(loadedDhd()), dhd_(library_) {
  const int id = dhd_.openID(static_cast<char>(index));
  if (id < 0)
    throw Error(
        "dhd: device {} cannot be opened: {}; check cable and power, close other programs that use it, and "
        "see palpate doctor for permissions",
        index, lastError());
  device_ = static_cast<char>(id);
  const char* name = dhd_.getSystemName ? dhd_.getSystemName(device_) : nullptr;
  facts_.model = name ? name : "Force Dimension device";
  unsigned short serial = 0;
  if (dhd_.getSerialNumber && dhd_.getSerialNumber(&serial, device_) == 0 && serial != 0)  // 0: it has none
    facts_.serial = fmt::format("{}", serial);
  if (dhd_.getVersion) {
    int parts[4]{};
    dhd_.getVersion(&parts[0], &parts[1], &parts[2], &parts[3]);
    facts_.driver = fmt::format("{}.{}.{}.{}", parts[0], parts[1], parts[2], parts[3]);
  }
  const auto model = std::ranges::find_if(
      kDhdModels, [&](const DhdModel& limits) { return facts_.model.find(limits.name) != std::string::npos; });
  facts_.workspaceMin_mm = DVec3(-model->reach_mm);
  facts_.workspaceMax_mm = DVec3(model->reach_mm);
  limits_ = {
      .peakForce_N = model->peak_N, .continuousForce_N = model->continuous_N, .forceDelay_ticks = 1, .buttons = 2};
  if (dhd_.setWatchdog(kWatchdog_ms, device_) < 0 || dhd_.enableForce(1, device_) < 0) {
    const std::string why = lastError();
    dhd_.close(device_);
    throw Error("dhd: {} does not accept forces: {}; press its force button and start again", facts_.model, why);
  }
}

ForceDimensionDevice::~ForceDimensionDevice() {
  dhd_.setForce(0, 0, 0, device_);
  dhd_.enableForce(0, device_);
  dhd_.close(device_);
}

std::string ForceDimensionDevice::lastError() const {
  const char* text = dhd_.lastError ? dhd_.lastError() : nullptr;
  return text ? text : "the driver does not say why";
}

// The device's axes: x towards the user, y to the right, z up.
DeviceState ForceDimensionDevice::read(double /*time_s*/) noexcept {
  if (failed_.load()) return {};
  double x_m = 0, y_m = 0, z_m = 0;
  if (dhd_.getPosition(&x_m, &y_m, &z_m, device_) < 0) {
    fail(dhd_.lastError ? dhd_.lastError() : nullptr);
    return {};
  }
  if (!isFinite(DVec3(x_m, y_m, z_m))) {
    fail("the driver reports a position that is not a number");
    return {};
  }
  return {.position = kMm_per_metre * DVec3(y_m, z_m, x_m), .buttons = dhd_.getButtonMask(device_), .ok = true};
}

bool ForceDimensionDevice::write(const DVec3& force_N) noexcept {
  const bool sane = isFinite(force_N);
  const double size_N = sane ? glm::length(force_N) : 0;
  const bool gives = sane && !stopped_.load() && !failed_.load();
  const DVec3 force = !gives                         ? DVec3(0)
                      : size_N > limits_.peakForce_N ? force_N * (limits_.peakForce_N / size_N)
                                                     : force_N;
  if (dhd_.setForce(force.z, force.x, force.y, device_) < 0) {
    fail(dhd_.lastError ? dhd_.lastError() : nullptr);
    return false;
  }
  return sane && !failed_.load();
}

void ForceDimensionDevice::fail(const char* why) noexcept {
  if (failed_.load()) return;
  if (why) std::strncpy(fault_.data(), why, fault_.size() - 1);
  failed_.store(true);
}

std::string ForceDimensionDevice::faultText() const {
  if (!failed_.load()) return {};
  return fmt::format("{}: {}; check cable and power of the device, and start again", facts_.model,
                     fault_[0] ? fault_.data() : "no communication with the device");
}

}  // namespace palpate

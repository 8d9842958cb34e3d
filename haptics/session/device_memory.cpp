#include "haptics/session/device_memory.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/core/atomic_file.hpp"
#include "engine/core/error.hpp"
#include "engine/io/setting_json.hpp"
#include "haptics/devices/device_axes.hpp"
#include "haptics/devices/system_devices.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate {
namespace {

constexpr int kVersion = 1;
constexpr const char *kVersionKey = "version", *kChosenKey = "window", *kDevicesKey = "devices";

constexpr Setting<RememberedDevice> kDevice[]{
    {"model", &RememberedDevice::model, "", "model of the device"},
    {"stiffness_N_per_mm",
     &RememberedDevice::stiffness_N_per_mm,
     "",
     "largest stiffness of a contact, N/mm",
     "N/mm",
     {.min = 0, .max = bounds::kMaxStiffness_N_per_mm, .excludesMin = true}},
    {"axes", &RememberedDevice::axes, "", "axes of the device to the right, up and towards the user"},
};

bool isOf(std::string_view key, std::string_view device) {
  return key == device || (key.starts_with(device) && key.substr(device.size()).starts_with(':'));
}

std::filesystem::path fileOfUser() {
  const std::filesystem::path folder = userConfiguration();
  return folder.empty() ? folder : folder / "palpate" / "devices.json";
}

RememberedDevice deviceFrom(const std::string& path, const SettingsJson& json) {
  RememberedDevice device;
  readSettings(path, json, settingsOf(&device), device);
  forEachBounded(settingsOf(&device), device, [&](const Setting<RememberedDevice>& setting, double value) {
    requireIn(setting.range, pathOf(path, setting.name), value);
  });
  if (!device.axes.empty() && !DeviceAxes::named(device.axes))
    throw ConfigError(pathOf(path, "axes"), "is '{}', not a permutation as in x,z,-y", device.axes);
  return device;
}

}  // namespace

std::span<const Setting<RememberedDevice>> settingsOf(const RememberedDevice*) { return kDevice; }

std::string RememberedDevice::inWords() const {
  std::string words;
  if (stiffness_N_per_mm) words = fmt::format("stiffness at most {:.3g} N/mm", *stiffness_N_per_mm);
  if (!axes.empty()) words += fmt::format("{}axes {}", words.empty() ? "" : ", ", axes);
  return words;
}

std::string deviceKey(std::string_view kind, std::string_view serial) {
  return serial.empty() ? std::string() : fmt::format("{}:{}", kind, serial);
}

DeviceMemory::DeviceMemory() : file_(fileOfUser()) {}

DeviceMemory::Content DeviceMemory::read() const {
  Content content;
  std::ifstream in(file_);
  if (file_.empty() || !in) return content;
  try {
    const SettingsJson json = SettingsJson::parse(in);
    requireObject("", json);
    requireKnown("", json, {kVersionKey, kChosenKey, kDevicesKey});
    if (json.value(kVersionKey, SettingsJson(0)) != kVersion)
      throw ConfigError(kVersionKey, "is not {}, which this palpate reads", kVersion);
    if (const SettingsJson* const chosen = setting_json::find(json, kChosenKey))
      setting_json::read(kChosenKey, *chosen, {}, &content.chosen);
    const SettingsJson devices = json.value(kDevicesKey, SettingsJson::object());
    requireObject(kDevicesKey, devices);
    for (const auto& [key, device] : devices.items())
      content.devices.emplace(key, deviceFrom(pathOf(kDevicesKey, key), device));
  } catch (const std::exception& error) {  // from JSON or from a setting
    throw FileError(file_,
                    fmt::format("cannot be read, so no device is remembered ({}); correct or remove it", error.what()));
  }
  return content;
}

void DeviceMemory::write(const Content& content) const {
  if (file_.empty()) throw Error("devices cannot be remembered: the user has no home folder");
  SettingsJson json{{kVersionKey, kVersion}, {kChosenKey, content.chosen}, {kDevicesKey, SettingsJson::object()}};
  for (const auto& [key, device] : content.devices)
    writeSettings(json[kDevicesKey][key] = SettingsJson::object(), settingsOf(&device), device);
  std::error_code failed;
  std::filesystem::create_directories(file_.parent_path(), failed);
  if (failed) throw FileError(file_, "cannot be written: " + failed.message());
  AtomicFile out(file_);
  out.write(json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  out.commit();
}

std::map<std::string, RememberedDevice> DeviceMemory::devices() const { return read().devices; }

RememberedDevice DeviceMemory::find(const std::string& key) const {
  const auto devices = read().devices;
  const auto found = devices.find(key);
  return found == devices.end() ? RememberedDevice() : found->second;
}

void DeviceMemory::remember(const std::string& key, const RememberedDevice& device) const {
  if (key.empty()) throw Error("{}: it reports no serial number, so nothing can be remembered for it", device.model);
  Content content = read();
  if (device.isEmpty())
    content.devices.erase(key);
  else
    content.devices.insert_or_assign(key, device);
  write(content);
}

std::string DeviceMemory::chosen() const { return read().chosen; }

void DeviceMemory::choose(const std::string& device) const {
  Content content = read();
  if (content.chosen == device || (content.chosen.empty() && device == "mouse")) return;
  content.chosen = device;
  write(content);
}

std::vector<std::string> DeviceMemory::forget(const std::string& device) const {
  Content content = read();
  std::vector<std::string> forgotten;
  for (const auto& [key, unused] : content.devices)
    if (isOf(key, device)) forgotten.push_back(key);
  for (const std::string& key : forgotten) content.devices.erase(key);
  const bool wasChosen = isOf(content.chosen, device);
  if (wasChosen) content.chosen.clear();
  if (wasChosen || !forgotten.empty()) write(content);
  return forgotten;
}

}  // namespace palpate

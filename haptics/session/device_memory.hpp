// What a user has agreed to for each of their devices, kept between programs in the user's configuration folder.
// Nothing is stored on a device.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/setting.hpp"

namespace palpate {

/// Settings of one device.
struct RememberedDevice {
  std::string model;                         ///< for people who read the file
  std::optional<double> stiffness_N_per_mm;  ///< stable in this user's hand; sessions do not exceed it
  std::string axes;                          ///< DeviceAxes::text(); empty: the device's own

  bool isEmpty() const { return !stiffness_N_per_mm && axes.empty(); }
  /// "stiffness at most 1.2 N/mm, axes x,z,-y".
  std::string inWords() const;
  bool operator==(const RememberedDevice&) const = default;
};
std::span<const Setting<RememberedDevice>> settingsOf(const RememberedDevice*);

/// Kind and serial number, as in "haply:049D"; empty if the device reports no serial number.
std::string deviceKey(std::string_view kind, std::string_view serial);

/// The file devices.json. Each function reads it again, since other programs write it, too; all throw FileError if it
/// cannot be read or written, and then leave it as it is.
class DeviceMemory {
 public:
  /// The memory of the user of this program.
  DeviceMemory();
  /// `file` need not exist; empty: nothing is remembered, and remember() and choose() throw Error.
  explicit DeviceMemory(std::filesystem::path file) : file_(std::move(file)) {}

  const std::filesystem::path& file() const { return file_; }
  /// By deviceKey().
  std::map<std::string, RememberedDevice> devices() const;
  /// Nothing remembered: an empty one.
  RememberedDevice find(const std::string& key) const;
  /// An empty one is forgotten.
  void remember(const std::string& key, const RememberedDevice& device) const;

  /// The device that the window used last, as in HandConfig::device or "mouse"; empty if it never had one.
  std::string chosen() const;
  void choose(const std::string& device) const;

  /// Forgets the devices of that name, as in "haply:049D" or, for all of a kind, "haply", and their choice. Returns
  /// their keys.
  std::vector<std::string> forget(const std::string& device) const;

 private:
  struct Content {
    std::string chosen;
    std::map<std::string, RememberedDevice> devices;
  };
  Content read() const;
  void write(const Content& content) const;

  std::filesystem::path file_;
};

}  // namespace palpate

// The service of Haply devices on this machine, as it answers at the start of a session.
#pragma once

#include <memory>
#include <string>

#include "haptics/devices/haply_link.hpp"
#include "haptics/devices/haply_protocol.hpp"

namespace palpate {

/// A connection, and what the service told first. Throws Error that says what is missing and what to do.
struct HaplyService {
  HaplyService();

  /// The device with this serial number, or the only one. `shares`: also one that another program uses. Throws Error.
  const haply::Inverse& device(const std::string& serial, bool shares) const;
  /// The connected grip at the device's place among several; null if there is none.
  const haply::Grip* gripOf(const haply::Inverse& inverse) const;

  haply::Ports ports;
  HaplyLink link;
  std::string first;  ///< message
  haply::Inventory inventory;
  std::string version;                ///< empty if it does not tell
  std::unique_ptr<HaplyLink> events;  ///< null if the service has no such channel
};

}  // namespace palpate

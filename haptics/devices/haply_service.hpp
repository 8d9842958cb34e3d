// The service of Haply devices on this machine, as it answers at the start of a session.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "haptics/devices/haply_protocol.hpp"

namespace palpate {

/// A WebSocket, and a question over HTTP, to the service of Haply devices: on this machine only, with a limit for each
/// wait.
/// Used by one thread at a time.
class HaplyLink {
 public:
  /// Connects to a port of this machine's loopback, within 2 s. Throws Error.
  explicit HaplyLink(std::uint16_t port);
  /// Says goodbye.
  ~HaplyLink();
  HaplyLink(const HaplyLink&) = delete;
  HaplyLink& operator=(const HaplyLink&) = delete;

  enum class Heard { message, nothing, closed };
  /// Waits for the next message. After `nothing`, part of one may have come; the next call continues.
  Heard hear(double timeout_s, std::string& message);
  /// False if the connection is closed, or takes nothing for that long and is given up.
  bool say(std::string message, double timeout_s);

 private:
  struct System;
  std::unique_ptr<System> system_;
};

/// Body of the answer to GET; empty if no answer comes within `timeout_s`, or with an error.
std::optional<std::string> askHaplyService(std::uint16_t port, const std::string& path, double timeout_s);

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

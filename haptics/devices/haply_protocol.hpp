// The text that the service of Haply devices (haply-inverse-service 3.0 to 3.5) exchanges with programs.
#pragma once

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate::haply {

/// Ports of the service on this machine.
struct Ports {
  std::uint16_t simulation = 10001, events = 10020;
  std::vector<std::uint16_t> http{10001, 10000};  ///< tried in turn: 3.5 answers at the first, older ones at the second
};
/// From the service's configuration file, or from the one that PALPATE_HAPLY_CONFIG names; the defaults where none
/// exists. Throws FileError if it cannot be read.
Ports servicePorts();

/// What a device is in.
enum class Trouble : std::uint8_t {
  none,
  closed,         ///< the service closed the connection
  silent,         ///< no state for 20 ms
  unreadable,     ///< a message that is not JSON
  gone,           ///< the device is missing in the states
  noNumber,       ///< a position that is not a number
  jumped,         ///< faster than a hand
  notCalibrated,  ///< poses are wrong by centimetres
  noPower,        ///< only the computer's USB port feeds it
  safety,         ///< the firmware has stopped it
  shared          ///< another program applies a force to it
};
/// Meaning of the light of a device, one line per colour.
inline constexpr std::string_view kLights =
    "white: ready, no force\ngreen: force\nred: no data\npurple: not calibrated\ncyan: stopped by its safety";
/// Whether a state with it has a pose.
constexpr bool hasPose(Trouble trouble) {
  return trouble == Trouble::none || trouble == Trouble::notCalibrated || trouble == Trouble::noPower;
}
/// As a sentence without a subject, with the light that the device then shows, and what to do.
std::string_view meaningOf(Trouble trouble);

/// Axes of positions and forces, from a permutation as in `config/basis/permutation` (XYZ, X-ZY...), to x right, y up,
/// z towards the user. Its inverse is its transpose. Empty if it is not a permutation.
std::optional<glm::dmat3> axesOf(std::string_view permutation);

/// A device as in the first message after a connection.
struct Inverse {
  std::string id, firmware, handedness = "right", permutation = "XYZ";
  bool calibrated = true, powered = true, inUse = false, small = false;
};
struct Grip {
  std::string id;
  bool wireless = true, connected = true;
  std::optional<double> battery;  ///< 0 to 1
};
struct Inventory {
  std::vector<Inverse> inverses;
  std::vector<Grip> grips;
};
/// Empty if the message is unreadable.
std::optional<Inventory> inventoryIn(std::string_view message);

/// Which device and grip a session uses, and how its numbers are to be read.
struct Choice {
  std::string id, grip;
  bool wireless = true;
  glm::dmat3 axes{1};
};

/// A device's state, in palpate's axes.
struct State {
  DVec3 position_mm{0};
  DQuat turn{1, 0, 0, 0};
  std::uint32_t buttons = 0;
  std::optional<DVec3> force_N;     ///< that the service says it applies, of all programs; empty: it does not say
  Trouble trouble = Trouble::none;  ///< if any, position and orientation are those before
};
/// `last`: kept where a message leaves something out.
State stateIn(std::string_view message, const Choice& choice, const State& last);

/// Services up to 3.1 call the force's vector `values`, later ones `vector`.
bool saysValues(std::string_view version);
/// `force_N`: in palpate's axes. `profile`: whether the message tells the program's name, as the first one does.
std::string forceMessage(const Choice& choice, const DVec3& force_N, bool values, bool profile);

/// Number of the version in an answer of /version, as in "3.5.0"; empty without one.
std::string versionIn(std::string_view answer);

/// What an event of the service means for a device.
enum class Safety : std::uint8_t {
  other,    ///< nothing
  struck,   ///< a moment's intervention
  stopped,  ///< until it is released
  released
};
Safety safetyIn(std::string_view event, std::string_view id);

}  // namespace palpate::haply

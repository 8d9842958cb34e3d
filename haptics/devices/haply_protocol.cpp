#include "haptics/devices/haply_protocol.hpp"

#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/matrix.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "haptics/devices/system_devices.hpp"

namespace palpate::haply {
namespace {

using Json = nlohmann::json;

constexpr double kMm_per_metre = 1000;
/// Haply's axes (x right, y forward, z up) to palpate's; a column for each of Haply's.
constexpr glm::dmat3 kFromHaply{1, 0, 0, 0, 0, -1, 0, 1, 0};

/// The member at the end of a path of names, or null.
const Json* memberOf(const Json& json, std::initializer_list<const char*> path) {
  const Json* at = &json;
  for (const char* name : path) {
    if (!at->is_object()) return nullptr;
    const auto found = at->find(name);
    if (found == at->end()) return nullptr;
    at = &*found;
  }
  return at;
}

std::string textAt(const Json& json, std::initializer_list<const char*> path, const std::string& otherwise = {}) {
  const Json* text = memberOf(json, path);
  return text && text->is_string() ? text->get<std::string>() : otherwise;
}

bool flagAt(const Json& json, std::initializer_list<const char*> path, bool otherwise) {
  const Json* flag = memberOf(json, path);
  return flag && flag->is_boolean() ? flag->get<bool>() : otherwise;
}

/// NaN if it is not a number.
double numberAt(const Json& json, const char* name) {
  const Json* number = memberOf(json, {name});
  return number && number->is_number() ? number->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

DVec3 vectorAt(const Json& json) { return {numberAt(json, "x"), numberAt(json, "y"), numberAt(json, "z")}; }

/// The entries of a kind of device.
const Json& entriesOf(const Json& message, const char* kind) {
  static const Json kNone = Json::array();
  const Json* entries = memberOf(message, {kind});
  return entries && entries->is_array() ? *entries : kNone;
}

const Json* packedState(const Json& message, const char* kind, const std::string& id) {
  for (const Json& entry : entriesOf(message, kind))
    if (textAt(entry, {"device_id"}) == id) return &entry;
  return nullptr;
}

const char* kindOf(bool wireless) { return wireless ? "wireless_verse_grip" : "verse_grip"; }

std::string firmwareOf(const Json& entry) {
  const std::string extended = textAt(entry, {"config", "extended_firmware_version"});
  const Json* info = memberOf(entry, {"config", "device_info"});
  if (!extended.empty() || !info) return extended;
  const Json *major = memberOf(*info, {"major_version"}), *minor = memberOf(*info, {"minor_version"});
  return major && minor ? fmt::format("{}.{}", major->dump(), minor->dump()) : std::string();
}

std::uint16_t portAt(const Json& json, const char* key, std::uint16_t otherwise, const std::filesystem::path& file) {
  const auto found = json.find(key);
  if (found == json.end()) return otherwise;
  if (!found->is_number_integer() || found->get<std::int64_t>() < 1 || found->get<std::int64_t>() > 65535)
    throw FileError(file, fmt::format("{} is not a port, 1 to 65535", key));
  return found->get<std::uint16_t>();
}

Trouble statusOf(const Json& entry) {
  if (!flagAt(entry, {"status", "power_supply"}, true)) return Trouble::noPower;
  return flagAt(entry, {"status", "calibrated"}, true) ? Trouble::none : Trouble::notCalibrated;
}

void readGrip(const Json& entry, const glm::dmat3& axes, State& state) {
  if (const Json* orientation = memberOf(entry, {"state", "orientation"})) {
    // A mirrored basis mirrors the sense of a rotation.
    const DVec3 axis = glm::determinant(axes) * (axes * vectorAt(*orientation));
    const DQuat turn(numberAt(*orientation, "w"), axis.x, axis.y, axis.z);
    const double size = glm::dot(turn, turn);
    if (std::isfinite(size) && size > 0.5) state.turn = turn / std::sqrt(size);
  }
  constexpr std::array<const char*, 3> kButtons{"a", "b", "c"};
  std::uint32_t pressed = flagAt(entry, {"state", "button"}, false);
  for (std::uint32_t i = 0; i < kButtons.size(); ++i)
    if (flagAt(entry, {"state", "buttons", kButtons[i]}, false)) pressed |= 1U << i;
  state.buttons = pressed;
}

}  // namespace

Ports servicePorts() {
  const char* own = std::getenv("PALPATE_HAPLY_CONFIG");
  const std::filesystem::path file = own ? std::filesystem::path(own) : haplyConfiguration();
  Ports ports;
  std::ifstream in(file);
  if (!in) return ports;
  const Json json = Json::parse(in, nullptr, false);
  if (!json.is_object()) throw FileError(file, "is not the JSON of the Haply service's configuration");
  ports.simulation = portAt(json, "communication/websocket/port", ports.simulation, file);
  ports.events = portAt(json, "communication/events/port", ports.events, file);
  ports.http[0] = ports.simulation;
  ports.http[1] = portAt(json, "communication/http/port", ports.http[1], file);
  return ports;
}

std::string_view meaningOf(Trouble trouble) {
  switch (trouble) {
    case Trouble::none:
      return "is ready (white light: idle, green: force)";
    case Trouble::closed:
      return "is lost: the Haply service closed the connection; start the service, and the session, again";
    case Trouble::silent:
      return "gives no data (red light), so there is no force; check the Haply service, cable and power";
    case Trouble::unreadable:
      return "cannot be read: the Haply service sent a message that is not JSON, so there is no force; update the "
             "service";
    case Trouble::gone:
      return "is no longer connected (red light if its program lost it), so there is no force; check cable and power";
    case Trouble::noNumber:
      return "reports a position that is not a number, so there is no force; calibrate it";
    case Trouble::jumped:
      return "jumped faster than a hand can move, so there is no force until it is in free space; check its cable";
    case Trouble::notCalibrated:
      return "is not calibrated (purple light), so its pose is wrong and there is no force; put the grip on the "
             "inkwell "
             "until the light is white";
    case Trouble::noPower:
      return "has no power supply, so there is no force; plug in its power supply";
    case Trouble::safety:
      return "was stopped by its safety (cyan light), so there is no force; let go of it until the light is white";
    case Trouble::shared:
      return "receives forces from another program, so palpate sends none; close that program, or add both forces with "
             "haply:SERIAL:shared";
  }
  return {};
}

std::optional<glm::dmat3> axesOf(std::string_view permutation) {
  glm::dmat3 toHaply(0);  // a column for each of the program's axes
  int axis = 0;
  double sign = 1;
  std::array<bool, 3> used{};
  for (const char letter : permutation) {
    if (letter == '+' || letter == '-') {
      sign = letter == '-' ? -1 : 1;
      continue;
    }
    const int k = std::toupper(static_cast<unsigned char>(letter)) - 'X';
    if (axis == 3 || k < 0 || k > 2 || used[static_cast<std::size_t>(k)]) return std::nullopt;
    used[static_cast<std::size_t>(k)] = true;
    toHaply[axis++][k] = sign;
    sign = 1;
  }
  if (axis != 3) return std::nullopt;
  return kFromHaply * toHaply;
}

std::optional<Inventory> inventoryIn(std::string_view message) {
  const Json json = Json::parse(message, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  Inventory found;
  for (const Json& entry : entriesOf(json, "inverse3"))
    found.inverses.push_back({.id = textAt(entry, {"device_id"}),
                              .firmware = firmwareOf(entry),
                              .handedness = textAt(entry, {"config", "handedness"}, "right"),
                              .permutation = textAt(entry, {"config", "basis", "permutation"}, "XYZ"),
                              .calibrated = flagAt(entry, {"status", "calibrated"}, true),
                              .powered = flagAt(entry, {"status", "power_supply"}, true),
                              .inUse = flagAt(entry, {"status", "in_use"}, false),
                              .small = textAt(entry, {"config", "type"}) == "minverse"});
  for (const bool wireless : {true, false})
    for (const Json& entry : entriesOf(json, kindOf(wireless))) {
      Grip grip{.id = textAt(entry, {"device_id"}),
                .wireless = wireless,
                .connected = flagAt(entry, {"status", "connected"}, true)};
      if (const Json* battery = memberOf(entry, {"state", "battery_level"}); battery && battery->is_number())
        grip.battery = battery->get<double>();
      found.grips.push_back(std::move(grip));
    }
  return found;
}

State stateIn(std::string_view message, const Choice& choice, const State& last) {
  State state = last;
  const Json json = Json::parse(message, nullptr, false);
  if (!json.is_object()) {
    state.trouble = Trouble::unreadable;
    return state;
  }
  const Json* entry = packedState(json, "inverse3", choice.id);
  const Json* position = entry ? memberOf(*entry, {"state", "cursor_position"}) : nullptr;
  if (!position) {
    state.trouble = Trouble::gone;
    return state;
  }
  const DVec3 position_mm = kMm_per_metre * (choice.axes * vectorAt(*position));
  if (!isFinite(position_mm)) {
    state.trouble = Trouble::noNumber;
    return state;
  }
  state.trouble = statusOf(*entry);
  state.position_mm = position_mm;
  const Json* force = memberOf(*entry, {"state", "current_cursor_force"});
  const DVec3 force_N = force ? choice.axes * vectorAt(*force) : DVec3(std::numeric_limits<double>::quiet_NaN());
  state.force_N = isFinite(force_N) ? std::optional(force_N) : std::nullopt;
  if (const Json* grip = packedState(json, kindOf(choice.wireless), choice.grip)) readGrip(*grip, choice.axes, state);
  return state;
}

bool saysValues(std::string_view version) {
  int major = 0, minor = 0;
  const std::string text(version);
  return std::sscanf(text.c_str(), "%d.%d", &major, &minor) == 2 && (major < 3 || (major == 3 && minor <= 1));
}

std::string forceMessage(const Choice& choice, const DVec3& force_N, bool values, bool profile) {
  const DVec3 force = glm::transpose(choice.axes) * force_N;
  Json message{{"inverse3",
                {{{"device_id", choice.id},
                  {"commands",
                   {{"set_cursor_force",
                     {{values ? "values" : "vector", {{"x", force.x}, {"y", force.y}, {"z", force.z}}}}}}}}}}};
  if (profile) message["session"]["configure"]["profile"]["name"] = "palpate";
  return message.dump();
}

std::string versionIn(std::string_view answer) {
  const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
  const std::size_t key = answer.find("\"version\"");
  for (std::size_t i = key == std::string_view::npos ? 0 : key; i + 2 < answer.size(); ++i) {
    if (!isDigit(answer[i]) || answer[i + 1] != '.' || !isDigit(answer[i + 2])) continue;
    std::size_t end = i;
    while (end < answer.size() && (isDigit(answer[end]) || answer[end] == '.')) ++end;
    return std::string(answer.substr(i, end - i));
  }
  return {};
}

Safety safetyIn(std::string_view event, std::string_view id) {
  const Json json = Json::parse(event, nullptr, false);
  if (textAt(json, {"name"}) != "device-safety-triggered") return Safety::other;
  const std::string whose = textAt(json, {"data", "device_id"}), type = textAt(json, {"data", "safety_type"});
  if (!whose.empty() && whose != id) return Safety::other;
  // A release, or a step to a lower risk, is told with a level below a warning.
  const std::string level = textAt(json, {"level"});
  if (level == "info" || level == "notice") return Safety::released;
  return type == "stall_detected" || type == "stability_ceiling" ? Safety::struck : Safety::stopped;
}

}  // namespace palpate::haply

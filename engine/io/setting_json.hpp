// A section of settings as a JSON object, read and written by its table. Only files that handle JSON include this,
// because each file that includes the library takes seconds longer to compile.
#pragma once

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <nlohmann/json.hpp>

#include "engine/core/setting.hpp"

namespace palpate {

using SettingsJson = nlohmann::ordered_json;

/// Throws ConfigError if the value is not an object.
inline void requireObject(std::string_view path, const SettingsJson& json) {
  if (!json.is_object()) throw ConfigError(path.empty() ? "config" : path, "is not an object");
}

/// Throws ConfigError for the first key of an object that is not in `known`; names with a dot are keys of a part.
inline void requireKnown(std::string_view path, const SettingsJson& json, const std::vector<std::string_view>& known) {
  for (const auto& [key, inside] : json.items()) {
    const std::string name = key, part = name + ".";
    if (std::ranges::find(known, name) != known.end()) continue;
    std::vector<std::string_view> ofPart;
    for (const std::string_view each : known)
      if (each.starts_with(part)) ofPart.push_back(each.substr(part.size()));
    if (ofPart.empty()) throw ConfigError(pathOf(path, name), "is unknown; there are {}", fmt::join(known, ", "));
    requireObject(pathOf(path, name), inside);
    requireKnown(pathOf(path, name), inside, ofPart);
  }
}

/// Conversion of each type of value. The functions throw ConfigError that names the path.
namespace setting_json {

inline double number(std::string_view path, const SettingsJson& json) {
  if (!json.is_number() || !std::isfinite(json.get<double>()))
    throw ConfigError(path, "is {}, not a number", json.dump());
  return json.get<double>();
}

// Checks the range, since the library would wrap a number that does not fit.
template <std::unsigned_integral T>
T whole(std::string_view path, const SettingsJson& json) {
  const double value = json.is_number() ? json.get<double>() : -1;
  if (!(value >= 0 && value <= static_cast<double>(std::numeric_limits<T>::max()) && std::floor(value) == value))
    throw ConfigError(path, "is {}, not a whole number from 0 to {}", json.dump(), std::numeric_limits<T>::max());
  return json.get<T>();
}

inline std::string text(std::string_view path, const SettingsJson& json) {
  if (!json.is_string()) throw ConfigError(path, "is {}, not a text", json.dump());
  return json.get<std::string>();
}

inline void requireList(std::string_view path, const SettingsJson& json, std::size_t count, std::string_view what) {
  if (!json.is_array() || json.size() != count)
    throw ConfigError(path, "is {}, not a list of {} {}", json.dump(), count, what);
}

inline DVec3 vector(std::string_view path, const SettingsJson& json) {
  requireList(path, json, 3, "numbers");
  return {number(path, json[0]), number(path, json[1]), number(path, json[2])};
}

template <class T>
SettingsJson write(const T& value) {
  return value;
}
inline SettingsJson write(const DVec3& value) { return {value.x, value.y, value.z}; }
inline SettingsJson write(double value) {
  return std::isfinite(value) ? SettingsJson(value) : SettingsJson(nullptr);  // JSON has no infinity
}
inline SettingsJson write(const Corners& value) {
  return value ? SettingsJson{write((*value)[0]), write((*value)[1])} : SettingsJson(nullptr);
}
template <class T>
SettingsJson write(const std::optional<T>& value) {
  return value ? write(*value) : SettingsJson(nullptr);
}

inline void read(std::string_view path, const SettingsJson& json, const Range& range, double& value) {
  value = json.is_null() && range.max == Range::kInfinity ? Range::kInfinity : number(path, json);
}
inline void read(std::string_view path, const SettingsJson& json, const Range&, bool& value) {
  if (!json.is_boolean()) throw ConfigError(path, "is {}, neither true nor false", json.dump());
  value = json.get<bool>();
}
template <std::unsigned_integral T>
void read(std::string_view path, const SettingsJson& json, const Range&, T& value) {
  value = whole<T>(path, json);
}
inline void read(std::string_view path, const SettingsJson& json, const Range&, std::string& value) {
  value = text(path, json);
}
inline void read(std::string_view path, const SettingsJson& json, const Range&, std::vector<std::string>& value) {
  if (!json.is_array()) throw ConfigError(path, "is {}, not a list of texts", json.dump());
  value.clear();
  for (const SettingsJson& each : json) value.push_back(text(path, each));
}
inline void read(std::string_view path, const SettingsJson& json, const Range&, DVec3& value) {
  value = vector(path, json);
}
inline void read(std::string_view path, const SettingsJson& json, const Range&, std::array<std::uint8_t, 3>& value) {
  requireList(path, json, value.size(), "numbers");
  for (std::size_t k = 0; k < value.size(); ++k) value[k] = whole<std::uint8_t>(path, json[k]);
}
inline void read(std::string_view path, const SettingsJson& json, const Range&, std::array<DVec3, 2>& value) {
  requireList(path, json, value.size(), "corners of a box");
  for (std::size_t k = 0; k < value.size(); ++k) value[k] = vector(path, json[k]);
}
template <class T>
void read(std::string_view path, const SettingsJson& json, const Range& range, std::optional<T>& value) {
  value.reset();
  if (!json.is_null()) read(path, json, range, value.emplace());
}

template <class Section>
SettingsJson write(const WordMember<Section>& words, const Section& section) {
  const std::string_view name = words.name(section);
  return name.empty() ? SettingsJson(nullptr) : SettingsJson(std::string(name));
}
template <class Section>
void read(std::string_view path, const SettingsJson& json, const WordMember<Section>& words, Section& section) {
  if (json.is_null() && words.clear) return words.clear(section);
  if (!words.choose(section, text(path, json)))
    throw ConfigError(path, "cannot be '{}'; there is {}", json.get<std::string>(), fmt::join(words.all(), ", "));
}

}  // namespace setting_json

/// The value of one setting.
template <class Section>
SettingsJson jsonOf(const Setting<Section>& setting, const Section& section) {
  return withValue(setting, section, [&](const auto& value) -> SettingsJson {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, WordMember<Section>>)
      return setting_json::write(value, section);
    else
      return setting_json::write(value);
  });
}

/// Writes a section into a JSON object, in the order of its table.
template <class Rows, class Section>
void writeSettings(SettingsJson& json, const Rows& rows, const Section& section) {
  for (const Setting<Section>& setting : rows) {
    const std::size_t dot = setting.name.find('.');
    const bool ofPart = dot != setting.name.npos;
    SettingsJson& part = ofPart ? json[std::string(setting.name.substr(0, dot))] : json;
    part[std::string(setting.name.substr(ofPart ? dot + 1 : 0))] = jsonOf(setting, section);
  }
}

/// Reads the settings that a JSON object has; the others keep their values. `others`: keys that are read elsewhere.
/// Throws ConfigError for an unknown key, and for a value of another type.
template <class Rows, class Section>
void readSettings(std::string_view path, const SettingsJson& json, const Rows& rows, Section& section,
                  std::vector<std::string_view> others = {}) {
  requireObject(path, json);
  for (const Setting<Section>& setting : rows) others.push_back(setting.name);
  requireKnown(path, json, others);
  for (const Setting<Section>& setting : rows) {
    const std::size_t dot = setting.name.find('.');
    const auto outer = json.find(std::string(setting.name.substr(0, dot)));
    if (outer == json.end()) continue;
    const SettingsJson* found = &*outer;
    if (dot != setting.name.npos) {
      const auto inner = outer->find(std::string(setting.name.substr(dot + 1)));
      if (inner == outer->end()) continue;
      found = &*inner;
    }
    const std::string at = pathOf(path, setting.name);
    withValue(setting, section, [&](auto& value) {
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, WordMember<Section>>)
        setting_json::read(at, *found, value, section);
      else
        setting_json::read(at, *found, setting.range, value);
    });
  }
}

}  // namespace palpate

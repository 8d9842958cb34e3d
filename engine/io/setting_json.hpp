// A section of settings as a JSON object, read and written by its table. Only setting_json.cpp includes the JSON
// library, and the files that make or take apart an object.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>

#include "engine/core/setting.hpp"

namespace palpate {

using SettingsJson = nlohmann::ordered_json;

/// Throws ConfigError if the value is not an object.
void requireObject(std::string_view path, const SettingsJson& json);
/// Throws ConfigError for the first key of an object that is not in `known`; names with a dot are keys of a part.
void requireKnown(std::string_view path, const SettingsJson& json, const std::vector<std::string_view>& known);

/// The value of a member. A word is its name, which is empty where the member has none.
namespace setting_json {

template <class... Values>
struct PointersTo {
  using In = std::variant<Values*...>;
  using Out = std::variant<const Values*...>;
};
using Pointers = PointersTo<bool, double, std::uint32_t, std::size_t, std::string, DVec3, std::array<std::uint8_t, 3>,
                            std::vector<std::string>, std::optional<double>, std::optional<std::uint32_t>,
                            std::optional<DVec3>, Corners>;

/// The value at a setting's name in an object; a name with a dot is of a part. Null if there is none.
const SettingsJson* find(const SettingsJson& json, std::string_view name);
/// The same; a missing one is made, and so is its part.
SettingsJson& make(SettingsJson& json, std::string_view name);
/// Throws ConfigError that names the path, for a value of another type.
void read(std::string_view path, const SettingsJson& json, const Range& range, const Pointers::In& value);
/// A name, or nothing for null where `mayBeNull`; then `choose` is called, and `all` has the names if it returns false.
void readWord(std::string_view path, const SettingsJson& json, bool mayBeNull,
              const std::function<bool(const std::string* word)>& choose, std::vector<std::string> (*all)());
void write(SettingsJson& json, const Pointers::Out& value);
void writeWord(SettingsJson& json, std::string_view word);
/// What is written to a value, as text.
std::string textOf(const std::function<void(SettingsJson& json)>& write);

}  // namespace setting_json

/// Writes the value of one setting.
template <class Section>
void writeSetting(SettingsJson& json, const Setting<Section>& setting, const Section& section) {
  withValue(setting, section, [&](const auto& value) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, WordMember<Section>>)
      setting_json::writeWord(json, value.name(section));
    else
      setting_json::write(json, &value);
  });
}

/// The value of one setting as JSON text.
template <class Section>
std::string textOf(const Setting<Section>& setting, const Section& section) {
  return setting_json::textOf([&](SettingsJson& json) { writeSetting(json, setting, section); });
}

/// Writes a section into a JSON object, in the order of its table.
template <class Rows, class Section>
void writeSettings(SettingsJson& json, const Rows& rows, const Section& section) {
  for (const Setting<Section>& setting : rows) writeSetting(setting_json::make(json, setting.name), setting, section);
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
    const SettingsJson* const found = setting_json::find(json, setting.name);
    if (!found) continue;
    const std::string at = pathOf(path, setting.name);
    withValue(setting, section, [&](auto& value) {
      if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, WordMember<Section>>)
        setting_json::readWord(
            at, *found, value.clear != nullptr,
            [&](const std::string* word) {
              if (!word) value.clear(section);
              return !word || value.choose(section, *word);
            },
            value.all);
      else
        setting_json::read(at, *found, setting.range, &value);
    });
  }
}

}  // namespace palpate

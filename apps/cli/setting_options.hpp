// Command-line options of the settings of a session: name, help, bounds and choices come from the table of settings.
#pragma once

#include "apps/cli/options.hpp"
#include "haptics/session/settings.hpp"

namespace palpate {

/// The requirement on a number of a setting.
template <class Section>
Check boundsOf(const Setting<Section>& setting) {
  const Range& range = setting.range;
  const bool isWhole = std::holds_alternative<std::uint32_t Section::*>(setting.member) ||
                       std::holds_alternative<std::size_t Section::*>(setting.member) ||
                       std::holds_alternative<std::optional<std::uint32_t> Section::*>(setting.member);
  return isWhole ? wholeBetween(range.min, range.max) : between(range);
}

/// The names of a setting's values, after the words in `before`.
template <class Section>
std::vector<std::string> choicesOf(std::string_view name, std::vector<std::string> before = {}) {
  for (std::string& word : std::get<WordMember<Section>>(settingNamed<Section>(name).member).all())
    before.push_back(std::move(word));
  return before;
}

/// "X,Y,Z" and "R,G,B".
std::string listText(const DVec3& vector);
std::string listText(const std::array<std::uint8_t, 3>& color);
/// Throw UsageError that names the option.
void readList(std::string_view option, const std::string& text, DVec3& vector);
void readList(std::string_view option, const std::string& text, std::array<std::uint8_t, 3>& color);

/// Adds the option of a setting that sets the member of a section, or the flag of one that is true or false.
template <class Section>
Option addSetting(Options& command, Section& section, std::string_view name) {
  const Setting<Section>& setting = settingNamed<Section>(name);
  const std::string flag(setting.flag), help(setting.help);
  return withValue(setting, section, [&](auto& value) -> Option {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, WordMember<Section>>) {
      const auto set = [&section, words = value](const std::string& text) { words.choose(section, text); };
      const auto usual = [&section, words = value] { return std::string(words.name(section)); };
      return command.add(flag, set, usual, help).check(oneOf(value.all()));
    } else if constexpr (std::is_same_v<Value, bool>) {
      return setting.flagNegates ? command.addNegatedFlag(flag, value, help) : command.addFlag(flag, value, help);
    } else if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::optional<std::uint32_t>>) {
      return command.add(flag, value, help).check(boundsOf(setting)).unit(setting.unit);
    } else if constexpr (std::is_same_v<Value, DVec3> || std::is_same_v<Value, std::array<std::uint8_t, 3>>) {
      return command.add(
          flag, [&value, flag](const std::string& text) { readList(flag, text, value); },
          [&value] { return listText(value); }, help);
    } else if constexpr (std::is_same_v<Value, std::string> || std::is_same_v<Value, std::vector<std::string>>) {
      return command.add(flag, value, help);
    } else {
      throw std::logic_error(fmt::format("{} has no option of its own", name));
    }
  });
}

/// Adds the options of all settings of a section but one, with their defaults.
template <class Section>
void addSettings(Options& command, Section& section, std::string_view except) {
  for (const Setting<Section>& setting : settingsOf<Section>())
    if (!setting.flag.empty() && setting.name != except) addSetting(command, section, setting.name).showDefault();
}

/// Adds the option of a setting that sets a variable of the caller, whose type may differ from the member's. Numbers
/// have the setting's bounds; the caller adds other checks.
template <class Section>
Option addSettingFor(Options& command, auto& variable, std::string_view name) {
  const Setting<Section>& setting = settingNamed<Section>(name);
  const std::string flag(setting.flag), help(setting.help);
  if constexpr (std::is_same_v<std::remove_cvref_t<decltype(variable)>, bool>)
    return command.addFlag(flag, variable, help);
  else if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(variable)>>)
    return command.add(flag, variable, help).check(boundsOf(setting)).unit(setting.unit);
  else
    return command.add(flag, variable, help).unit(setting.unit);
}

}  // namespace palpate

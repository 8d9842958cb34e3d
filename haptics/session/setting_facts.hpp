// What a reference page says of a setting.
#pragma once

#include "engine/io/setting_json.hpp"

namespace palpate {

/// The type of a setting's value in words.
template <class T>
constexpr std::string_view kTypeName = "text";
template <>
constexpr std::string_view kTypeName<bool> = "true or false";
template <>
constexpr std::string_view kTypeName<double> = "number";
template <>
constexpr std::string_view kTypeName<std::uint32_t> = "whole number";
template <>
constexpr std::string_view kTypeName<std::size_t> = "whole number";
template <>
constexpr std::string_view kTypeName<DVec3> = "[x, y, z]";
template <>
constexpr std::string_view kTypeName<std::array<std::uint8_t, 3>> = "[red, green, blue]";
template <>
constexpr std::string_view kTypeName<std::vector<std::string>> = "texts";
template <>
constexpr std::string_view kTypeName<std::array<DVec3, 2>> = "two [x, y, z]";
template <class T>
constexpr std::string_view kTypeName<std::optional<T>> = kTypeName<T>;

template <class Section>
SettingFacts factsOf(std::string_view path, const Setting<Section>& setting, const Section& usual) {
  SettingFacts facts{.path = pathOf(path, setting.name),
                     .type = {},
                     .words = {},
                     .unit = std::string(setting.unit),
                     .usual = textOf(setting, usual),
                     .range = setting.range,
                     .help = (setting.flagNegates ? "false: " : "") + std::string(setting.help),
                     .flag = std::string(setting.flag),
                     .since = setting.since};
  withValue(setting, usual, [&](const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, WordMember<Section>>) {
      facts.type = "word";
      facts.words = value.all();
    } else {
      facts.type = kTypeName<Value>;
    }
  });
  return facts;
}

}  // namespace palpate

// One description of each setting: a row of a plain table. Reading, writing, bounds, command line, completion and the
// reference page come out of these rows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// A setting is out of bounds or incompatible with another one. The text begins with the setting's path, as in
/// "brush.radius_mm".
class ConfigError : public UsageError {
 public:
  template <class... Args>
  explicit ConfigError(std::string_view field, fmt::format_string<Args...> text, Args&&... args)
      : UsageError("{}: {}", field, fmt::format(text, std::forward<Args>(args)...)), field_(field) {}

  const std::string& field() const { return field_; }

 private:
  std::string field_;
};

/// Path of a setting in its section; an empty one is the outermost.
inline std::string pathOf(std::string_view section, std::string_view name) {
  return section.empty() ? std::string(name) : fmt::format("{}.{}", section, name);
}

/// Bounds of a number.
struct Range {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double min = -kInfinity, max = kInfinity;
  bool excludesMin = false;  ///< the value must be above `min`
  bool orZero = false;       ///< 0 is valid, too: the program chooses

  bool contains(double value) const {
    return (orZero && value == 0) || (value <= max && (excludesMin ? value > min : value >= min));
  }
  bool isBounded() const { return min > -kInfinity || max < kInfinity; }
};
/// Throws ConfigError that names the path and the bounds.
void requireIn(const Range& range, std::string_view path, double value);
/// "0 to 1", "above 0", "0, or 1e-06 to 1e+09".
std::string inWords(const Range& range);

/// A member of a section that has one of some named values.
template <class Section>
struct WordMember {
  std::string_view (*name)(const Section& section);  ///< empty: none
  bool (*choose)(Section& section, std::string_view name);
  std::vector<std::string> (*all)();
  void (*clear)(Section& section) = nullptr;  ///< null: one of the names is required
};

template <class T>
struct MemberOf;
template <class Section, class Value>
struct MemberOf<Value Section::*> {
  using Of = Section;
  using Type = Value;
};

/// A member, or an optional member, with the values of a table of names.
template <auto kMember, const auto& kNames>
constexpr auto words() {
  using Section = typename MemberOf<decltype(kMember)>::Of;
  using Value = typename MemberOf<decltype(kMember)>::Type;
  using Named = typename std::remove_cvref_t<decltype(kNames)>::value_type::second_type;
  WordMember<Section> member{.name = [](const Section& section) -> std::string_view {
                               if constexpr (std::is_same_v<Value, std::optional<Named>>)
                                 return section.*kMember ? nameOf(kNames, *(section.*kMember)) : std::string_view{};
                               else
                                 return nameOf(kNames, section.*kMember);
                             },
                             .choose =
                                 [](Section& section, std::string_view name) {
                                   const auto value = valueNamed(kNames, name);
                                   if (value) section.*kMember = *value;
                                   return value.has_value();
                                 },
                             .all = [] { return namesOf(kNames); }};
  if constexpr (std::is_same_v<Value, std::optional<Named>>)
    member.clear = [](Section& section) { (section.*kMember).reset(); };
  return member;
}

/// A number in a part of a section; the setting's name has a dot, as in "tool.mass_kg".
template <class Section>
struct PartMember {
  double& (*of)(Section& section);
  const double& (*in)(const Section& section);
};
template <auto kPart, auto kMember>
constexpr auto part() {
  using Section = typename MemberOf<decltype(kPart)>::Of;
  return PartMember<Section>{.of = [](Section& section) -> double& { return section.*kPart.*kMember; },
                             .in = [](const Section& section) -> const double& { return section.*kPart.*kMember; }};
}

using Corners = std::optional<std::array<DVec3, 2>>;  ///< of a box
template <class Section>
using SettingMember = std::variant<bool Section::*, double Section::*, std::uint32_t Section::*, std::size_t Section::*,
                                   std::string Section::*, DVec3 Section::*, std::array<std::uint8_t, 3> Section::*,
                                   std::vector<std::string> Section::*, std::optional<double> Section::*,
                                   std::optional<std::uint32_t> Section::*, std::optional<DVec3> Section::*,
                                   Corners Section::*, WordMember<Section>, PartMember<Section>>;

/// One setting. Its default is the initial value of its member.
template <class Section>
struct Setting {
  std::string_view name;  ///< its JSON key
  SettingMember<Section> member;
  std::string_view flag;       ///< option of the command line, as in "--strength"; empty: none
  std::string_view help;       ///< one clause, which names the unit
  std::string_view unit = {};  ///< empty: none
  Range range = {};
  Range slider = {};         ///< useful values, of a slider; unbounded: it has none
  bool flagNegates = false;  ///< the flag means false
  int since = 1;             ///< version of the configuration's format that has it first
};

/// A setting without the type of its section, for documents and tests.
struct SettingFacts {
  std::string path;                ///< as in "brush.radius_mm"
  std::string type;                ///< "number", "whole number", "true or false", "text", "x, y, z", ...
  std::vector<std::string> words;  ///< the valid values, if they have names
  std::string unit, usual;         ///< default, as JSON
  Range range;
  std::string help, flag;
  int since = 1;
};

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;  // clang 14 requires it

/// Calls `use` with the member's value, or with the section and the WordMember.
template <class Section>
decltype(auto) withValue(const Setting<Section>& setting, auto& section, auto&& use) {
  constexpr bool kConst = std::is_const_v<std::remove_reference_t<decltype(section)>>;
  return std::visit(Overloaded{[&](const WordMember<Section>& words) { return use(words); },
                               [&](const PartMember<Section>& member) {
                                 if constexpr (kConst)
                                   return use(member.in(section));
                                 else
                                   return use(member.of(section));
                               },
                               [&](auto member) { return use(section.*member); }},
                    setting.member);
}

/// Gives a member the value that it has in another section.
template <class Section>
void copySetting(const Setting<Section>& setting, const Section& from, Section& to) {
  std::visit(Overloaded{[&](const WordMember<Section>& words) {
                          const std::string_view name = words.name(from);
                          if (!name.empty())
                            words.choose(to, name);
                          else if (words.clear)
                            words.clear(to);
                        },
                        [&](const PartMember<Section>& member) { member.of(to) = member.in(from); },
                        [&](auto member) { to.*member = from.*member; }},
             setting.member);
}

/// Calls `use` with each number that has bounds, its setting and, for a vector, once for each axis.
template <class Rows, class Section>
void forEachBounded(const Rows& rows, const Section& section, auto&& use) {
  for (const Setting<Section>& setting : rows) {
    if (!setting.range.isBounded()) continue;
    withValue(setting, section, [&](const auto& value) {
      using Value = std::remove_cvref_t<decltype(value)>;
      if constexpr (std::is_same_v<Value, std::optional<double>> ||
                    std::is_same_v<Value, std::optional<std::uint32_t>>) {
        if (value) use(setting, static_cast<double>(*value));
      } else if constexpr (std::is_arithmetic_v<Value>) {
        use(setting, static_cast<double>(value));
      } else if constexpr (std::is_same_v<Value, DVec3>) {
        for (int k = 0; k < 3; ++k) use(setting, value[k]);
      }
    });
  }
}

/// The setting of that name. Throws std::logic_error if the table has none.
template <class Section>
const Setting<Section>& settingNamed(std::span<const Setting<Section>> rows, std::string_view name) {
  for (const Setting<Section>& setting : rows)
    if (setting.name == name) return setting;
  throw std::logic_error(fmt::format("there is no setting {}", name));
}

}  // namespace palpate

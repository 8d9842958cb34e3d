// The tables of settings: complete, and true to what the session does.
#include "haptics/session/settings.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

namespace palpate::settings_test {

namespace {

// Ends of names that are units, and the unit as a text.
constexpr std::pair<std::string_view, std::string_view> kUnits[]{{"_mm_per_s", "mm/s"}, {"_N_s_per_mm", "N s/mm"},
                                                                 {"_N_per_mm", "N/mm"}, {"_N_per_s", "N/s"},
                                                                 {"_mm", "mm"},         {"_MiB", "MiB"},
                                                                 {"_Hz", "Hz"},         {"_kg_m3", "kg/m^3"},
                                                                 {"_Pa_s", "Pa s"},     {"_Pa", "Pa"},
                                                                 {"_N_m", "N/m"},       {"_m_s2", "m/s^2"},
                                                                 {"_kg", "kg"},         {"_W", "W"},
                                                                 {"_s", "s"},           {"_N", "N"}};

std::string unitInName(const std::string& path) {
  for (const auto& [end, unit] : kUnits)
    if (path.ends_with(end)) return std::string(unit);
  return {};
}

// The field that a configuration text is refused for; empty if it is accepted.
std::string refusedFor(const std::string& text) {
  try {
    parseConfig(text);
  } catch (const ConfigError& error) {
    return error.field();
  }
  return {};
}

// A configuration in which one setting has this value, as JSON.
std::string with(const std::string& path, const std::string& value) {
  const std::size_t dot = path.rfind('.');
  if (dot == path.npos) return fmt::format(R"({{"version": 1, "{}": {}}})", path, value);
  const std::string section = path.substr(0, dot), inside = fmt::format("\"{}\": {}", path.substr(dot + 1), value);
  if (section == "hands") return fmt::format(R"({{"version": 1, "hands": [{{{}}}]}})", inside);
  const std::string_view joined = section == "join" ? R"("model": {"file": "name"}, )" : "";
  return fmt::format(R"({{"version": 1, {}"{}": {{{}}}}})", joined, section, inside);
}

}  // namespace

TEST_CASE("each setting has a path, an option and a help text of its own, and the help names its unit") {
  std::set<std::string> paths, flags;
  const std::vector<SettingFacts> all = allSettings();
  CHECK(all.size() > 60);
  for (const SettingFacts& setting : all) {
    CAPTURE(setting.path);
    CHECK(paths.insert(setting.path).second);
    if (!setting.flag.empty()) CHECK(flags.insert(setting.flag).second);
    CHECK(setting.help.size() > 10);
    if (setting.path != "model.mm_per_unit" && unitInName(setting.path) != "")
      CHECK(setting.unit == unitInName(setting.path));
    if (!setting.unit.empty() && setting.unit.find('/') == std::string::npos && setting.path != "rate_Hz")
      CHECK((setting.help.find(setting.unit) != std::string::npos || setting.help.find("millimetres") < 40));
    CHECK(setting.since >= 1);
    CHECK(setting.since <= SessionConfig::kVersion);
  }
}

TEST_CASE("a number is accepted up to its bounds and refused beyond them, by its path") {
  std::size_t checked = 0;
  for (const SettingFacts& setting : allSettings()) {
    if (!setting.range.isBounded() || setting.path.starts_with("matter")) continue;  // a scene is planned as a whole
    CAPTURE(setting.path);
    const std::string said = setting.path.starts_with("hands.") ? "hands[0]" + setting.path.substr(5) : setting.path;
    const Range& range = setting.range;
    const double above = range.excludesMin ? range.min + 1e-9 : range.min;
    CHECK(refusedFor(with(setting.path, fmt::format("{}", above))) == "");
    CHECK(refusedFor(with(setting.path, fmt::format("{}", std::min(range.min - 1, -1.0)))) == said);
    if (range.max < Range::kInfinity) {
      CHECK(refusedFor(with(setting.path, fmt::format("{:.0f}", range.max))) == "");
      CHECK(refusedFor(with(setting.path, fmt::format("{:.0f}", 2 * range.max + 1))) == said);
    }
    if (range.orZero) CHECK(refusedFor(with(setting.path, "0")) == "");
    if (range.excludesMin) CHECK(refusedFor(with(setting.path, fmt::format("{}", range.min))) == said);
    ++checked;
  }
  CHECK(checked > 25);
}

TEST_CASE("a word is accepted if the table names it, and refused otherwise with the names") {
  for (const SettingFacts& setting : allSettings()) {
    if (setting.words.empty() || setting.path.starts_with("matter")) continue;
    CAPTURE(setting.path);
    CHECK_THROWS_WITH_AS(parseConfig(with(setting.path, "\"blunt\"")), doctest::Contains(setting.words.back().c_str()),
                         ConfigError);
    for (const std::string& word : setting.words) {
      const std::string field = refusedFor(with(setting.path, "\"" + word + "\""));
      CHECK(field == "");
    }
  }
}

TEST_CASE("the defaults that the table states are those of an empty configuration") {
  const std::string text = configText({});
  for (const SettingFacts& setting : allSettings()) {
    if (setting.path.find('.') != std::string::npos && !setting.path.starts_with("force.")) continue;
    CAPTURE(setting.path);
    const std::string line = "\"" + setting.path.substr(setting.path.find('.') + 1) + "\": " + setting.usual;
    CHECK_MESSAGE(text.find(line) != std::string::npos, line);
  }
}

TEST_CASE("an error about a hand names the option of that hand") {
  CHECK(flagOf("brush.strength") == "--strength");
  CHECK(flagOf("hands[0].path") == "--path");
  CHECK(flagOf("hands[1].path") == "--hand");
  CHECK(flagOf("hands[7].device") == "--hand");
  CHECK(flagOf("hands[1].penetration_mm") == "--penetration");
  CHECK(flagOf("hands") == "--hand");
  CHECK(flagOf("force.max_rise_N_per_s").empty());
  CHECK(flagOf("no.such_setting").empty());
}

}  // namespace palpate::settings_test

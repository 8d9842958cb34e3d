// The configuration of a session as JSON text and back, by its tables.
#include <nlohmann/json.hpp>

#include "engine/io/setting_json.hpp"
#include "haptics/session/settings.hpp"
#include "haptics/session/simulation.hpp"

namespace palpate {

namespace {

// Settings of earlier versions, which their logs contain, and the only value that a session has now; empty where each
// value gives the same session.
constexpr struct {
  const char *section, *name, *usual;
} kFormerSettings[]{{"backend", "wait", ""},
                    {"index", "sort", ""},
                    {"index", "cells_along_side", "0"},
                    {"index", "spare_slots", "null"}};

void dropFormerSettings(SettingsJson& json) {
  for (const auto& [section, name, usual] : kFormerSettings) {
    const auto found = json.find(section);
    if (found == json.end() || !found->is_object() || !found->contains(name)) continue;
    const SettingsJson& value = found->at(name);
    if (const std::string_view only = usual; !only.empty() && value != SettingsJson::parse(only))
      throw ConfigError(pathOf(section, name), "is {}; this setting was removed, and only {} is accepted", value.dump(),
                        only);
    found->erase(name);
  }
}

SettingsJson parsed(std::string_view text) {
  try {
    return SettingsJson::parse(text);
  } catch (const nlohmann::json::exception& error) {
    throw Error("the configuration is not valid JSON: {}", error.what());
  }
}

struct SectionWriter {
  SettingsJson& json;

  template <class Section>
  void operator()(const char* name, const Section& section, Presence) const {
    writeSettings(json[name] = SettingsJson::object(), settingsOf<Section>(), section);
  }
  template <class Section>
  void operator()(const char* name, const std::optional<Section>& section, Presence presence) const {
    if (section)
      (*this)(name, *section, presence);
    else if (presence == Presence::nullIfAbsent)
      json[name] = nullptr;
  }
};

struct SectionReader {
  const SettingsJson& json;
  std::vector<std::string_view> known = {"version", "matter", "hands"};

  template <class Section>
  void operator()(const char* name, Section& section, Presence) {
    known.emplace_back(name);
    if (const auto found = json.find(name); found != json.end())
      readSettings(name, *found, settingsOf<Section>(), section);
  }
  template <class Section>
  void operator()(const char* name, std::optional<Section>& section, Presence presence) {
    known.emplace_back(name);
    section.reset();
    if (const auto found = json.find(name); found != json.end() && !found->is_null())
      (*this)(name, section.emplace(), presence);
  }
};

}  // namespace

std::string configText(const SessionConfig& config) {
  SettingsJson json{{"version", SessionConfig::kVersion}};
  visitSections(config, SectionWriter{json});
  if (config.model.matter) json["matter"] = SettingsJson::parse(config.model.matter->text());
  json["hands"] = SettingsJson::array();
  for (const HandConfig& hand : config.hands)
    writeSettings(json["hands"].emplace_back(SettingsJson::object()), settingsOf<HandConfig>(), hand);
  writeSettings(json, settingsOf<SessionConfig>(), config);
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace);  // a file name may be no UTF-8
}

Preparation parsePreparation(std::string_view text) {
  Preparation preparation;
  readSettings("prepare", parsed(text), settingsOf<Preparation>(), preparation);
  validate(preparation);
  return preparation;
}

SessionConfig parseConfig(std::string_view text) {
  SettingsJson json = parsed(text);
  requireObject("", json);
  const SettingsJson version = json.value("version", SettingsJson(0));
  if (version != SessionConfig::kVersion)
    throw ConfigError("version", "is {}; this palpate reads {}", version.dump(), SessionConfig::kVersion);
  dropFormerSettings(json);
  SessionConfig config;
  SectionReader sections{json};
  visitSections(config, sections);
  if (const auto matter = json.find("matter"); matter != json.end() && !matter->is_null())
    config.model.matter = parseScene("matter", matter->dump());
  if (const auto hands = json.find("hands"); hands != json.end()) {
    if (!hands->is_array()) throw ConfigError("hands", "is {}, not a list", hands->dump());
    config.hands.clear();
    for (const SettingsJson& hand : *hands) {
      const std::string path = fmt::format("hands[{}]", config.hands.size());
      readSettings(path, hand, settingsOf<HandConfig>(), config.hands.emplace_back());
    }
  }
  readSettings("", json, settingsOf<SessionConfig>(), config, sections.known);
  validate(config);
  return config;
}

}  // namespace palpate

// The tables of all settings of a session: one row for each, from which its JSON, bounds, command-line option and the
// reference page are made. A scene of matter has a table of its own, in its annex.
#pragma once

#include "engine/core/setting.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

// The settings of each section, in the order of its JSON.
std::span<const Setting<ModelConfig>> settingsOf(const ModelConfig*);
std::span<const Setting<Preparation>> settingsOf(const Preparation*);
std::span<const Setting<BackendConfig>> settingsOf(const BackendConfig*);
std::span<const Setting<IndexConfig>> settingsOf(const IndexConfig*);
std::span<const Setting<SurfaceConfig>> settingsOf(const SurfaceConfig*);
std::span<const Setting<ToolConfig>> settingsOf(const ToolConfig*);
std::span<const Setting<BrushConfig>> settingsOf(const BrushConfig*);
std::span<const Setting<ForceOptions>> settingsOf(const ForceOptions*);
std::span<const Setting<UndoConfig>> settingsOf(const UndoConfig*);
std::span<const Setting<MotionConfig>> settingsOf(const MotionConfig*);
std::span<const Setting<StreamConfig>> settingsOf(const StreamConfig*);
std::span<const Setting<JoinConfig>> settingsOf(const JoinConfig*);
std::span<const Setting<HandConfig>> settingsOf(const HandConfig*);
std::span<const Setting<SessionConfig>> settingsOf(const SessionConfig*);

/// The settings of a section; those of SessionConfig are outside of any section.
template <class Section>
std::span<const Setting<Section>> settingsOf() {
  return settingsOf(static_cast<const Section*>(nullptr));
}

/// The setting of that name. Throws std::logic_error if the section has none.
template <class Section>
const Setting<Section>& settingNamed(std::string_view name) {
  return settingNamed(settingsOf<Section>(), name);
}

/// Whether a section may be absent, and how JSON says so.
enum class Presence { always, nullIfAbsent, leftOutIfAbsent };

/// Calls `visit(name, section, presence)` for each section, in the order of the JSON. The scene of matter, the hands
/// and the settings outside of any section follow them.
template <class Config>
void visitSections(Config& config, auto&& visit) {
  visit("model", config.model, Presence::always);
  visit("backend", config.backend, Presence::always);
  visit("index", config.index, Presence::always);
  visit("surface", config.surface, Presence::always);
  visit("tool", config.tool, Presence::always);
  visit("brush", config.brush, Presence::nullIfAbsent);
  visit("force", config.force, Presence::always);
  visit("undo", config.undo, Presence::always);
  visit("motion", config.motion, Presence::leftOutIfAbsent);
  visit("prepare", config.model.prepare, Presence::leftOutIfAbsent);
  visit("stream", config.model.stream, Presence::leftOutIfAbsent);
  visit("join", config.model.join, Presence::leftOutIfAbsent);
}

/// All settings of a session, with those of a scene of matter.
std::vector<SettingFacts> allSettings();

/// The command-line option of a setting, as in "--strength"; empty if it has none. `path`: as in "brush.strength";
/// "hands.path" and "hands[0].path" mean the first hand, "hands[1].path" the second one.
std::string flagOf(std::string_view path);

}  // namespace palpate

// Timed events from a file, for tests and demonstrations.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "apps/view/commands.hpp"
#include "apps/view/events.hpp"

namespace palpate {

/// Events that are queued together, before the next frame.
struct TapAction {
  std::vector<WindowEvent> events;
};
struct ResizeAction {
  UVec2 size_px{0};
};
struct MinimiseAction {
  bool on = true;
};
/// Writes the next picture to a file.
struct ScreenshotAction {
  std::string file;
};
/// Writes the state of the window to a file.
struct StateAction {
  std::string file;
};
/// While on, the script continues while a model is loaded or saved; otherwise its clock is stopped meanwhile.
struct ImpatientAction {
  bool on = true;
};
/// From now on the window asks about unsaved changes, and how to save, as without a script.
struct AskAction {};
/// Clicks the control of that name in the panels: several events, each in its own frame.
struct ClickAction {
  std::string name;
};

/// Stops the script until that file exists, to synchronise it with another program.
struct AwaitAction {
  std::string file;
};

using ScriptAction = std::variant<WindowEvent, ViewCommand, TapAction, ResizeAction, MinimiseAction, ScreenshotAction,
                                  StateAction, ImpatientAction, AskAction, ClickAction, AwaitAction>;

struct TimedAction {
  double time_s = 0;
  ScriptAction action;
};

/// An event of a script: its name, arguments and effect.
struct ScriptEvent {
  std::string_view name, arguments, effect;
};
std::span<const ScriptEvent> scriptEvents();
/// "key, mouse, ...".
std::string scriptEventNames();

/// One event of scriptEvents() a line, after its time in seconds; `#` comments. Times must not decrease. Throws
/// FileError with the line.
std::vector<TimedAction> readScript(const std::filesystem::path& file);

}  // namespace palpate

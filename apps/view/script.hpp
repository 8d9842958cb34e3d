// Timed events from a file, for tests and demonstrations.
#pragma once

#include <filesystem>

#include "apps/view/events.hpp"

namespace palpate {

/// Events that come together, before another picture is shown.
struct TapAction {
  std::vector<WindowEvent> events;
};
struct ResizeAction {
  UVec2 size_px{0};
};
struct MinimiseAction {
  bool on = true;
};
/// The next picture is written to a file.
struct ScreenshotAction {
  std::string file;
};
/// What is going on is written to a file.
struct StateAction {
  std::string file;
};
/// The model is saved to a file.
struct SaveAction {
  std::string file;
};
/// A session log is begun, or ended where no file is named; or one is played.
struct RecordAction {
  std::string file;
};
struct ReplayAction {
  std::string file;
};
/// While it is on, the script goes on while a model is loaded; otherwise its clock stands still meanwhile.
struct ImpatientAction {
  bool on = true;
};
/// From now on the window asks about changes that are not saved, and how to save, as it asks a person.
struct AskAction {};
/// What is named so in the panels is clicked: several events, each in a picture of its own.
struct ClickAction {
  std::string name;
};

/// The script stands still until that file is there: another program has come as far.
struct AwaitAction {
  std::string file;
};

/// A parameter of what moves by itself.
struct SetAction {
  std::string name;
  double value = 0;
};

using ScriptAction =
    std::variant<WindowEvent, TapAction, ResizeAction, MinimiseAction, ScreenshotAction, StateAction, SaveAction,
                 RecordAction, ReplayAction, ImpatientAction, AskAction, ClickAction, SetAction, AwaitAction>;

struct TimedAction {
  double time_s = 0;
  ScriptAction action;
};

/// One event a line, `#` comments: `TIME_S key NAME [down|up]` (NAME may be ctrl+z), `mouse X Y`,
/// `button left|middle|right down|up`, `tap X Y`, `tap KEY`, `wheel N`, `drop FILE`, `text WORDS`, `resize W H`,
/// `minimise`, `restore`, `screenshot FILE.png`, `state FILE.json`, `save FILE.ply`, `record FILE`, `record`, `replay
/// FILE`, `impatient`, `patient`, `ask`, `click NAME`, `set NAME VALUE`, `await FILE`, `quit`. Times do not fall.
/// Throws FileError with the line.
std::vector<TimedAction> readScript(const std::filesystem::path& file);

}  // namespace palpate

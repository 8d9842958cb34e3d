#include "apps/view/script.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <functional>
#include <utility>

#include "apps/view/window.hpp"
#include "engine/core/characters.hpp"
#include "engine/core/error.hpp"
#include "engine/core/unknown_name.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/render/image.hpp"

namespace palpate {

namespace {

constexpr ScriptEvent kEvents[]{
    {"key", "NAME [down|up]", "presses and releases a key, or several with + between them, as in ctrl+z"},
    {"mouse", "X Y", "moves the mouse, pixels"},
    {"button", "left|middle|right down|up", "presses or releases a button of the mouse"},
    {"tap", "X Y | KEY", "presses and releases in one picture, at a position or a key"},
    {"wheel", "N", "turns the wheel by N notches"},
    {"push", "X Y Z RX RY RZ [BUTTONS]", "pushes and turns the cap of a 3D mouse, -1 to 1 each"},
    {"click", "NAME", "clicks the control of that name in the panels"},
    {"drop", "FILE", "drops a file on the window"},
    {"text", "WORDS", "types a text"},
    {"resize", "W H", "resizes the window, pixels"},
    {"set", "NAME VALUE", "sets a parameter of a simulation"},
    {"minimise", "", "minimises the window"},
    {"restore", "", "restores it"},
    {"screenshot", "FILE.png", "writes a picture of the window"},
    {"state", "FILE.json", "writes the state of the window"},
    {"save", "FILE.ply", "saves the edited points"},
    {"export", "FILE.ply", "writes the selected points"},
    {"separate", "FILE.ply", "writes the selected points, and removes them"},
    {"value", "FIELD VALUE", "gives the selected points a value of a field"},
    {"layer", "new|open|close|hide|show|merge|STRENGTH [NAME]",
     "makes or changes a layer of strokes; without a name: the open one"},
    {"volume", "NUMBERS", "places the box, ball or plane that selects: as typed in the panel"},
    {"move", "X,Y,Z [A,B,C [FACTOR]]", "moves the selected points, rotates them by degrees about x, y and z, scales"},
    {"where", "CONDITION", "selects the points for which an expression of their fields holds"},
    {"clean", "{STEP}|normals HOW",
     "does one step that cleans, as in {\"fill_holes_mm\": 5}, or estimates, orients, flips"},
    {"record", "[FILE]", "records a session log; without a file: ends it"},
    {"replay", "FILE", "plays a session log"},
    {"impatient", "", "keeps the clock running while a model is loaded or saved"},
    {"patient", "", "stops the clock meanwhile, as at the beginning"},
    {"ask", "", "asks about unsaved changes from now on, as without a script"},
    {"await", "FILE", "stops the clock until the file exists, at most a minute"},
    {"quit", "", "closes the window"},
};

/// The words of one line, read one after the other.
class Line {
 public:
  Line(const std::filesystem::path& file, std::size_t number, std::string_view text)
      : file_(file), number_(number), text_(text) {}

  [[noreturn]] void fail(const std::string& what) const { throw FileError::atLine(file_, number_, what); }
  bool atEnd() const { return text_.find_first_not_of(kBlank) == std::string_view::npos; }

  std::string word(const char* what) {
    if (atEnd()) fail(fmt::format("{} is missing", what));
    text_.remove_prefix(text_.find_first_not_of(kBlank));
    const std::string_view found = text_.substr(0, text_.find_first_of(kBlank));
    text_.remove_prefix(found.size());
    return std::string(found);
  }
  double number(const char* what) { return numberIn(word(what), what); }
  double numberIn(const std::string& text, const char* what) const {
    double value = 0;
    const char* end = text.data() + text.size();
    const auto [last, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || last != end || !std::isfinite(value))
      fail(fmt::format("{}: '{}' is not a number", what, text));
    return value;
  }
  std::uint32_t size(const char* what) {
    const double value = number(what);
    if (!(value >= 1 && value <= 16384)) fail(fmt::format("{} is {}; it must be between 1 and 16384", what, value));
    return static_cast<std::uint32_t>(value);
  }
  /// The remainder of the line: file names may contain blanks.
  std::string rest(const char* what) {
    if (atEnd()) fail(fmt::format("{} is missing", what));
    text_.remove_prefix(text_.find_first_not_of(kBlank));
    const std::string_view found = std::exchange(text_, {});
    return std::string(found.substr(0, found.find_last_not_of(kBlank) + 1));
  }
  void end() {
    if (!atEnd()) fail(fmt::format("unexpected '{}'", rest("more")));
  }

 private:
  static constexpr const char* kBlank = " \t\r";
  const std::filesystem::path& file_;
  std::size_t number_;
  std::string_view text_;
};

std::vector<int> keysOf(const Line& line, const std::string& name) {
  std::vector<int> keys;
  for (std::size_t from = 0; from <= name.size();) {
    const std::size_t plus = std::min(name.find('+', from + 1), name.size());
    const auto key = keyNamed(std::string_view(name).substr(from, plus - from));
    if (!key)
      line.fail(fmt::format("unknown key '{}'; keys are {}, and several with + between them", name, keyNames()));
    keys.push_back(*key);
    from = plus + 1;
  }
  return keys;
}

// Constructs the action in place: after inlining a move, g++ 12 warns falsely of a read of an uninitialised string.
void add(std::vector<TimedAction>& actions, double time_s, const WindowEvent& event) {
  TimedAction& added = actions.emplace_back();
  added.time_s = time_s;
  added.action = event;
}

void addKey(Line& line, double time_s, std::vector<TimedAction>& actions) {
  const std::vector<int> keys = keysOf(line, line.word("the key"));
  const std::string how = line.atEnd() ? "" : line.word("down or up");
  if (!how.empty() && how != "down" && how != "up") line.fail(fmt::format("key: '{}' is neither down nor up", how));
  if (how != "up")
    for (const int key : keys) add(actions, time_s, KeyEvent{key, true});
  if (how != "down")
    for (auto key = keys.rbegin(); key != keys.rend(); ++key) add(actions, time_s, KeyEvent{*key, false});
}

WindowEvent buttonEvent(Line& line) {
  const std::string name = line.word("the button"), how = line.word("down or up");
  if (how != "down" && how != "up") line.fail(fmt::format("button: '{}' is neither down nor up", how));
  for (const auto& [known, button] :
       {std::pair{"left", MouseButton::left}, {"middle", MouseButton::middle}, {"right", MouseButton::right}})
    if (name == known) return ButtonEvent{button, how == "down"};
  line.fail(fmt::format("button: '{}' is not left, middle or right", name));
}

WindowEvent pushEvent(Line& line) {
  PushEvent event;
  for (const auto& [part, what] : {std::pair{&event.push, "the push"}, {&event.turn, "the turn"}})
    for (int k = 0; k < 3; ++k) {
      (*part)[k] = line.number(what);
      if (std::abs((*part)[k]) > 1) line.fail(fmt::format("{} is {}; it must be between -1 and 1", what, (*part)[k]));
    }
  if (!line.atEnd()) event.buttons = line.size("the buttons");
  return event;
}

// A tap on a touchpad or on a key: press and release are shorter than a frame.
TapAction tapOf(Line& line) {
  const std::string what = line.word("the position or the key");
  TapAction tap;
  if (line.atEnd()) {
    const std::vector<int> keys = keysOf(line, what);
    for (const int key : keys) tap.events.emplace_back(KeyEvent{key, true});
    for (auto key = keys.rbegin(); key != keys.rend(); ++key) tap.events.emplace_back(KeyEvent{*key, false});
    return tap;
  }
  const double x = line.numberIn(what, "x");
  tap.events.emplace_back(MouseEvent{{x, line.number("y")}});
  for (const bool down : {true, false}) tap.events.emplace_back(ButtonEvent{MouseButton::left, down});
  return tap;
}

/// The file that an action writes; `kind` throws UsageError for an ending that cannot be written.
std::string written(Line& line, const std::function<void(const std::string&)>& kind) {
  std::string file = line.rest("the file");
  try {
    kind(file);
  } catch (const UsageError& error) {
    line.fail(error.what());
  }
  return file;
}

CleanModel cleanOf(Line& line) {
  const std::string step = line.rest("the step");
  if (const std::string_view how = step; how.starts_with("normals ")) {
    const auto normals = valueNamed(kNormalSources, how.substr(how.find(' ') + 1));
    if (!normals) line.fail("normals: estimate, orient or flip");
    return {.step = {}, .normals = normals};
  }
  try {
    return {.step = parsePreparation(step)};
  } catch (const Error& error) {
    line.fail(error.what());
  }
}

// The name is the rest of the line.
ScriptAction layerOf(Line& line) {
  using What = LayerCommand::What;
  const std::string how = line.word("what is done with the layer");
  for (const auto& [name, what] : {std::pair{"new", What::add},
                                   {"open", What::open},
                                   {"close", What::close},
                                   {"hide", What::hide},
                                   {"show", What::show},
                                   {"merge", What::merge}})
    if (how == name) return ViewCommand(LayerCommand{what, line.atEnd() ? "" : line.rest("its name")});
  const double strength = line.numberIn(how, "new, open, close, hide, show, merge, or the strength");
  return ViewCommand(LayerCommand{What::slide, line.atEnd() ? "" : line.rest("its name"), strength});
}

ScriptAction actionOf(Line& line, const std::string& what) {
  if (what == "mouse") {
    const double x = line.number("x");
    return WindowEvent(MouseEvent{{x, line.number("y")}});
  }
  if (what == "button") return buttonEvent(line);
  if (what == "tap") return tapOf(line);
  if (what == "wheel") return WindowEvent(WheelEvent{line.number("the notches"), 0});
  if (what == "push") return pushEvent(line);
  if (what == "drop") return WindowEvent(DropEvent{{line.rest("the file")}});
  if (what == "resize") {
    const std::uint32_t width = line.size("the width");
    return ResizeAction{{width, line.size("the height")}};
  }
  if (what == "minimise" || what == "restore") return MinimiseAction{what == "minimise"};
  if (what == "screenshot") return ScreenshotAction{written(line, imageFormatOf)};
  if (what == "state") return StateAction{line.rest("the file")};
  for (const auto& [name, task] :
       {std::pair{"save", FileTask::saveAs}, {"export", FileTask::exportSelection}, {"separate", FileTask::separate}}) {
    const auto kind = [](const std::string& file) { cloudFormats().toWrite(file, Written::points); };
    if (what == name) return ViewCommand(FileCommand{task, written(line, kind)});
  }
  if (what == "value") {
    const std::string field = line.word("the field");
    return ViewCommand(SetValue{field, line.word("its value")});
  }
  if (what == "layer") return layerOf(line);
  if (what == "volume") return ViewCommand(SetVolume{line.rest("the numbers")});
  if (what == "move") {
    MoveSelection move{.way = line.word("the way"), .angles_deg = {}, .factor = {}};
    if (!line.atEnd()) move.angles_deg = line.word("the angles");
    if (!line.atEnd()) move.factor = line.word("the factor");
    return ViewCommand(move);
  }
  if (what == "where") return ViewCommand(SelectWhere{.condition = line.rest("the condition")});
  if (what == "clean") return ViewCommand(cleanOf(line));
  if (what == "record" && line.atEnd()) return ViewCommand(ModelCommand::endRecording);
  if (what == "record") return ViewCommand(FileCommand{FileTask::record, line.rest("the file")});
  if (what == "replay") return ViewCommand(FileCommand{FileTask::play, line.rest("the file")});
  if (what == "impatient" || what == "patient") return ImpatientAction{what == "impatient"};
  if (what == "ask") return AskAction{};
  if (what == "await") return AwaitAction{line.rest("the file")};
  if (what == "click") return ClickAction{line.rest("the name")};
  if (what == "set") {
    const std::string name = line.word("the parameter");
    return ViewCommand(SetParameter{name, line.number("its value")});
  }
  if (what == "quit") return WindowEvent(CloseEvent{});
  std::vector<std::string> names;
  for (const ScriptEvent& event : kEvents) names.emplace_back(event.name);
  line.fail(unknownName("event", what, names));
}

}  // namespace

std::span<const ScriptEvent> scriptEvents() { return kEvents; }

std::string scriptEventNames() {
  std::string names;
  for (const ScriptEvent& event : kEvents) names += (names.empty() ? "" : ", ") + std::string(event.name);
  return names;
}

std::vector<TimedAction> readScript(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw FileError(file, "cannot be opened; check that it exists and may be read");
  std::vector<TimedAction> actions;
  std::string text;
  for (std::size_t number = 1; std::getline(in, text); ++number) {
    Line line(file, number, std::string_view(text).substr(0, text.find('#')));
    if (line.atEnd()) continue;
    const double time_s = line.number("the time");
    if (time_s < (actions.empty() ? 0 : actions.back().time_s)) line.fail("the time is before that of the line above");
    const std::string what = line.word("the event");
    if (what == "key") {
      addKey(line, time_s, actions);
    } else if (what == "text") {
      for (const char32_t character : charactersOf(line.rest("the words"))) add(actions, time_s, TextEvent{character});
    } else {
      actions.push_back({time_s, actionOf(line, what)});
    }
    line.end();
  }
  return actions;
}

}  // namespace palpate

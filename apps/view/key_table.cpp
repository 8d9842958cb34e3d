#define GLFW_INCLUDE_NONE
#include "apps/view/key_table.hpp"

#include <GLFW/glfw3.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "engine/core/named_values.hpp"
#include "haptics/session/settings.hpp"

namespace palpate {

namespace {

using Tools = std::vector<WindowTool>;
using Set = std::function<void(WindowSettings&)>;
constexpr bool kWith = true, kWithout = false;
constexpr std::nullopt_t kEither = std::nullopt;

Set switches(bool ViewSettings::*what) {
  return [what](WindowSettings& settings) { settings.view.*what = !(settings.view.*what); };
}

Set chooses(SelectShape shape) {
  return [shape](WindowSettings& settings) { settings.select.shape = shape; };
}

// A second press goes back to sculpting.
Set switchesTo(WindowTool tool) {
  return [tool](WindowSettings& settings) { settings.use(settings.tool == tool ? WindowTool::sculpt : tool); };
}

// 0: only feel.
Set sculptsWith(std::size_t number) {
  return [number](WindowSettings& settings) {
    settings.use(WindowTool::sculpt);
    settings.brush.sculpts = number > 0;
    if (number > 0) settings.brush.kind = kBrushes[number - 1].kind;
  };
}

void measuresInstead(WindowSettings& settings) {
  settings.tool = WindowTool::look;
  settings.view.measures = true;
}

// By one press of [ or ].
Set resizes(bool isBrush, double factor) {
  return [=](WindowSettings& settings) {
    const Range& range = settingNamed<BrushConfig>("radius_mm").slider;
    double& radius_mm = isBrush ? settings.brush.radius_mm : settings.select.brush_mm;
    radius_mm = std::clamp(radius_mm * factor, range.min, range.max);
  };
}

// To the next size of the table, larger or smaller; 0: back to the usual one.
Set resizesText(int steps) {
  return [steps](WindowSettings& settings) {
    int& size = settings.view.text_percent;
    const auto now =
        std::ranges::find(kTextSizes, size, &std::pair<std::string_view, int>::second) - kTextSizes.begin();
    const auto next = std::clamp<std::ptrdiff_t>(now + steps, 0, std::ssize(kTextSizes) - 1);
    size = steps == 0 ? 100 : kTextSizes[static_cast<std::size_t>(next)].second;
  };
}

// Each opens its section of the panel, and closes the others.
std::vector<KeyBinding> sections() {
  std::vector<KeyBinding> bindings;
  for (std::size_t k = 0; k < kSections.size(); ++k)
    bindings.push_back({GLFW_KEY_F2 + static_cast<int>(k), kWithout, kEither, {Set([k](WindowSettings& settings) {
                          settings.view.panels = true;
                          settings.view.opens = kSections[k];
                        })}});
  return bindings;
}

std::vector<KeyBinding> numbered(bool isControl, std::size_t count,
                                 const std::function<KeyAction(std::size_t)>& action) {
  std::vector<KeyBinding> bindings;
  for (std::size_t k = 0; k < count; ++k)
    bindings.push_back({GLFW_KEY_1 + static_cast<int>(k), isControl, kEither, {action(k)}});
  return bindings;
}

// Along an axis, with Shift from behind.
std::vector<KeyBinding> axes() {
  std::vector<KeyBinding> bindings;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool isShift : {kWithout, kWith})
      bindings.push_back({GLFW_KEY_X + axis, kWithout, isShift, {LookAlong{axis, isShift}}});
  return bindings;
}

std::vector<KeyBinding> walking() {
  std::vector<KeyBinding> bindings;
  for (const auto& [key, direction] : {std::pair{GLFW_KEY_UP, WalkDirection::forward},
                                       {GLFW_KEY_DOWN, WalkDirection::back},
                                       {GLFW_KEY_LEFT, WalkDirection::left},
                                       {GLFW_KEY_RIGHT, WalkDirection::right},
                                       {GLFW_KEY_PAGE_UP, WalkDirection::up},
                                       {GLFW_KEY_PAGE_DOWN, WalkDirection::down}})
    bindings.push_back({key,
                        key == GLFW_KEY_PAGE_UP || key == GLFW_KEY_PAGE_DOWN ? std::optional(kWithout) : kEither,
                        kEither,
                        {WalkCommand{direction, true}},
                        {WalkCommand{direction, false}}});
  return bindings;
}

// By most of the panel's height; a walk by the same key ends, too.
std::vector<KeyBinding> scrolling() {
  const auto scrolls = [](int down) {
    return Set([down](WindowSettings& settings) { settings.view.scrolls += down; });
  };
  return {{GLFW_KEY_PAGE_UP, kWith, kEither, {scrolls(-1)}, {WalkCommand{WalkDirection::up, false}}},
          {GLFW_KEY_PAGE_DOWN, kWith, kEither, {scrolls(1)}, {WalkCommand{WalkDirection::down, false}}}};
}

// To the next smaller gain of the hand, and from the smallest one to 1.
void changesGain(WindowSettings& settings) {
  constexpr double kFinest = 0.25;
  double& gain = settings.feel.handGain;
  gain = gain > kFinest ? std::max(kFinest, gain / 2) : 1;
}

// Close what is drawn, and select with a volume.
std::vector<KeyBinding> closers() {
  std::vector<KeyBinding> bindings;
  for (const int key : {GLFW_KEY_ENTER, GLFW_KEY_KP_ENTER})
    for (const bool isControl : {kWithout, kWith})
      for (const bool isShift : {kWithout, kWith})
        bindings.push_back(
            {key, isControl, isShift, {SelectCommand::closeOutline, SelectVolume{combineBy(isShift, isControl)}}});
  return bindings;
}

std::vector<KeyRow> make() {
  constexpr double kStep = 1.1;
  const Tools sculpt{WindowTool::sculpt}, select{WindowTool::select}, others{WindowTool::sculpt, WindowTool::look},
      unsculpted{WindowTool::select, WindowTool::look}, all{WindowTool::sculpt, WindowTool::select, WindowTool::look};
  const auto plain = [](int key, std::vector<KeyAction> press) {
    return KeyBinding{key, kWithout, kEither, std::move(press)};
  };
  const auto controlled = [](int key, std::optional<bool> shift, std::vector<KeyAction> press) {
    return KeyBinding{key, kWith, shift, std::move(press)};
  };
  const Set closesHelp = [](WindowSettings& settings) { settings.view.help = settings.view.measures = false; };
  return {
      {sculpt,
       "hold Space",
       "the mouse is the stylus: move over the model",
       {{GLFW_KEY_SPACE, kEither, kEither, {StylusCommand::hold}, {StylusCommand::letGo}}}},
      {sculpt, "Space + left button", "press into the model, and sculpt with a brush"},
      {sculpt, "Space + wheel", "deeper, or less deep"},
      {sculpt, "hold Shift;  Ctrl",
       "with the stylus or a device: smooth;  the inverse of the brush (of push inflate, of inflate push, of carve "
       "inflate)"},
      {sculpt,
       "G",
       "the stylus moves as far as the device in the hand, half as far, or a quarter",
       {plain(GLFW_KEY_G, {changesGain})}},
      {sculpt, "T", "keep the stylus without holding Space", {plain(GLFW_KEY_T, {StylusCommand::lockOrUnlock})}},
      {others, "left drag", "rotate the view about the point under the cursor"},
      {others, "middle drag, Shift + left", "move the view"},
      {others, "double click", "look at the point under the cursor"},
      {select, "left drag", "selects; with Shift adds, with Ctrl removes, with both keeps what is in both"},
      {select, "right, middle drag", "rotate, move the view"},
      {all, "wheel", "zoom to the cursor"},
      {all,
       "S;  Shift+S",
       "select points, and back;  sculpt, with the brush as it is",
       {{GLFW_KEY_S, kWithout, kWithout, {switchesTo(WindowTool::select)}},
        {GLFW_KEY_S, kWithout, kWith, {Set([](WindowSettings& settings) { settings.use(WindowTool::sculpt); })}}}},
      {all,
       "V",
       "only look, so that nothing can be changed by the mouse, and back",
       {plain(GLFW_KEY_V, {switchesTo(WindowTool::look)})}},
      {select,
       "R;  L;  P",
       "select by a rectangle;  by a lasso;  by a polygon",
       {plain(GLFW_KEY_R, {chooses(SelectShape::rectangle)}), plain(GLFW_KEY_L, {chooses(SelectShape::lasso)}),
        plain(GLFW_KEY_P, {chooses(SelectShape::polygon)})}},
      {select,
       "B;  O;  E",
       "select by a brush, a ball on the surface;  flood: what is connected and alike;  everything alike: same class "
       "or "
       "colour",
       {{GLFW_KEY_B, kWithout, kWithout, {chooses(SelectShape::brush)}},
        plain(GLFW_KEY_O, {chooses(SelectShape::flood)}),
        plain(GLFW_KEY_E, {chooses(SelectShape::same)})}},
      {select,
       "A",
       "label: gives the points under a ball a class, or another value",
       {plain(GLFW_KEY_A, {chooses(SelectShape::label)})}},
      {select,
       "Shift+B",
       "lock by a brush, with its falloff, so that brushes leave these points; with Ctrl it frees them",
       {{GLFW_KEY_B, kWithout, kWith, {chooses(SelectShape::lock)}}}},
      {select,
       "W;  Shift+W;  D",
       "select by a box;  by a ball;  by the side of a plane: click the model, drag the handles, then Enter",
       {{GLFW_KEY_W, kWithout, kWithout, {chooses(SelectShape::box)}},
        {GLFW_KEY_W, kWithout, kWith, {chooses(SelectShape::ball)}},
        {GLFW_KEY_D, kWithout, kWithout, {chooses(SelectShape::plane)}}}},
      {select, "Shift+D", "measure between two positions", {{GLFW_KEY_D, kWithout, kWith, {Set(measuresInstead)}}}},
      {select,
       "G",
       "move, rotate or scale the selected points by handles",
       {plain(GLFW_KEY_G, {chooses(SelectShape::move)})}},
      {select, "Enter, right click",
       "close the polygon;  select what is in the box or ball, or beside the plane (with Shift, Ctrl as above)",
       closers()},
      {select,
       "Backspace, Alt + click",
       "take the polygon's last corner back",
       {plain(GLFW_KEY_BACKSPACE, {SelectCommand::takeBack})}},
      {select,
       "hold Space",
       "move the outline while it is drawn",
       {{GLFW_KEY_SPACE, kEither, kEither, {SelectCommand::holdOutline}, {SelectCommand::letOutlineGo}}}},
      {select,
       "T",
       "select through, also what is behind the first surface",
       {plain(GLFW_KEY_T, {[](WindowSettings& settings) { settings.select.through = !settings.select.through; }})}},
      {select,
       "Ctrl+A;  Ctrl+Shift+A;  Ctrl+I",
       "select all;  select none;  select the others",
       {controlled(GLFW_KEY_A, kWithout, {SelectCommand::all}), controlled(GLFW_KEY_A, kWith, {SelectCommand::none}),
        controlled(GLFW_KEY_I, kEither, {SelectCommand::invert})}},
      {select,
       "+;  -;  J",
       "grow the selection;  shrink it;  select what is connected with it",
       {plain(GLFW_KEY_EQUAL, {SelectCommand::grow}), plain(GLFW_KEY_MINUS, {SelectCommand::shrink}),
        plain(GLFW_KEY_J, {SelectCommand::connected}), plain(GLFW_KEY_KP_ADD, {SelectCommand::grow}),
        plain(GLFW_KEY_KP_SUBTRACT, {SelectCommand::shrink})}},
      {select,
       "H;  Shift+H;  I",
       "hide what is selected;  show all;  hide the others",
       {{GLFW_KEY_H, kWithout, kWithout, {SelectCommand::hide}},
        {GLFW_KEY_H, kWithout, kWith, {SelectCommand::showAll}},
        plain(GLFW_KEY_I, {SelectCommand::isolate})}},
      {select,
       "Ctrl+M;  Ctrl+Shift+M",
       "lock the selected points, which brushes then leave as they are;  unlock all",
       {controlled(GLFW_KEY_M, kWithout, {SelectCommand::lock}),
        controlled(GLFW_KEY_M, kWith, {SelectCommand::unlockAll})}},
      {select, "Delete", "remove the selected points", {plain(GLFW_KEY_DELETE, {SelectCommand::remove})}},
      {others, "R", "reset the view", {plain(GLFW_KEY_R, {WindowCommand::resetView})}},
      {all, "Home", "reset the view", {plain(GLFW_KEY_HOME, {WindowCommand::resetView})}},
      {all, "X  Y  Z", "look along an axis (Shift: from behind)", axes()},
      {all, "arrows, Page Up, Page Down", "walk while held: forward, back, sideways, up, down (Shift: faster)",
       walking()},
      {{WindowTool::look}, "right drag", "turn the head: look around from where you are"},
      {all, "U", "turn the model by 90 degrees, clockwise", {plain(GLFW_KEY_U, {WindowCommand::turnModel})}},
      {all, "Ctrl+1 to Ctrl+7", "look at the front, back, left, right, top, bottom, or isometric",
       numbered(kWith, kModelSides.size(), [](std::size_t k) { return kModelSides[k].second; })},
      {all,
       "Ctrl+8",
       "orthographic, or in perspective",
       {controlled(GLFW_KEY_8, kEither, {switches(&ViewSettings::orthographic)})}},
      {all, fmt::format("1 to {}", kBrushes.size() + 1),
       fmt::format("sculpt: {}", fmt::join(namesOf(kBrushKinds, {"feel"}), ", ")),
       numbered(kWithout, kBrushes.size() + 1, sculptsWith)},
      {sculpt,
       "[  ]",
       "smaller, larger brush",
       {plain(GLFW_KEY_LEFT_BRACKET, {resizes(true, 1 / kStep)}),
        plain(GLFW_KEY_RIGHT_BRACKET, {resizes(true, kStep)})}},
      {sculpt,
       "F;  Shift+F",
       "change the size of the brush;  its strength: move the mouse, then click or press Enter; Esc keeps the old one",
       {{GLFW_KEY_F, kWithout, kWithout, {BrushCommand::dragSize}},
        {GLFW_KEY_F, kWithout, kWith, {BrushCommand::dragStrength}}}},
      {sculpt,
       "L",
       "strokes go into a new layer, whose strength slides after the fact;  into none",
       {plain(GLFW_KEY_L, {LayerCommand{LayerCommand::What::addOrClose, {}}})}},
      {select,
       "[  ]",
       "smaller, larger brush of the selection",
       {plain(GLFW_KEY_LEFT_BRACKET, {resizes(false, 1 / kStep)}),
        plain(GLFW_KEY_RIGHT_BRACKET, {resizes(false, kStep)})}},
      {all,
       "Ctrl+Z;  Ctrl+Shift+Z",
       "undo;  redo",
       {controlled(GLFW_KEY_Z, kWithout, {ModelCommand::undo}), controlled(GLFW_KEY_Z, kWith, {ModelCommand::redo}),
        controlled(GLFW_KEY_Y, kEither, {ModelCommand::redo})}},
      {all,
       "Ctrl+S;  Ctrl+Shift+S;  Ctrl+O",
       "save;  save to another file;  open a file",
       {controlled(GLFW_KEY_S, kWithout, {ModelCommand::save}),
        controlled(GLFW_KEY_S, kWith, {BrowseCommand{FileTask::saveAs}}),
        controlled(GLFW_KEY_O, kEither, {BrowseCommand{FileTask::open}})}},
      {others, "Backspace", "forces off, and on again", {plain(GLFW_KEY_BACKSPACE, {WindowCommand::switchForces})}},
      {all,
       "M;  Ctrl+F",
       "triangles (marching cubes), or points;  cameras on and off",
       {plain(GLFW_KEY_M, {switches(&ViewSettings::mesh)}),
        controlled(GLFW_KEY_F, kEither, {switches(&ViewSettings::cameras)})}},
      {unsculpted, "F", "cameras on and off", {plain(GLFW_KEY_F, {switches(&ViewSettings::cameras)})}},
      {others, "D", "measure between two positions", {plain(GLFW_KEY_D, {switches(&ViewSettings::measures)})}},
      {all,
       "Ctrl+C",
       "copy the picked positions, with all their digits",
       {controlled(GLFW_KEY_C, kEither, {WindowCommand::copyPlaces})}},
      {all,
       "K;  .",
       "pause or continue a depth camera, water or sand;  show the next frame of a camera",
       {plain(GLFW_KEY_K, {ModelCommand::pause}), plain(GLFW_KEY_PERIOD, {ModelCommand::step})}},
      {all, "N", "restart water or sand", {plain(GLFW_KEY_N, {ModelCommand::restart})}},
      {others, "P", "picture of the model to a file (screenshot)", {plain(GLFW_KEY_P, {WindowCommand::screenshot})}},
      {all,
       "Ctrl+P",
       "picture of the model to a file (screenshot)",
       {controlled(GLFW_KEY_P, kEither, {WindowCommand::screenshot})}},
      {all,
       "C;  Tab",
       "curves on and off;  panels on and off",
       {plain(GLFW_KEY_C, {switches(&ViewSettings::plots)}), plain(GLFW_KEY_TAB, {switches(&ViewSettings::panels)})}},
      {others,
       "Esc",
       "take the stroke in progress back;  else stop reading;  close a list, an error or help;  put the stylus away;  "
       "end measuring",
       {{GLFW_KEY_ESCAPE,  // also of a stroke with Ctrl or Shift
         kEither,
         kEither,
         {BrushCommand::cancelStroke, closesHelp, WindowCommand::stopReading, StylusCommand::putAway,
          WindowCommand::closeErrors, WindowCommand::endMeasure}}}},
      {select,
       "Esc",
       "give the outline up;  stop reading;  close a list, an error or help",
       {plain(GLFW_KEY_ESCAPE,
              {SelectCommand::cancelOutline, closesHelp, WindowCommand::stopReading, WindowCommand::closeErrors})}},
      {all, fmt::format("F2 to F{}", kSections.size() + 1),
       fmt::format("open a section of the panel: {}", fmt::join(kSections, ", ")), sections()},
      {all, "Ctrl+Page Up;  Ctrl+Page Down", "scroll the panel up;  down", scrolling()},
      {all,
       "Ctrl++;  Ctrl+-;  Ctrl+0",
       "larger text;  smaller text;  text as large as at first",
       {controlled(GLFW_KEY_EQUAL, kEither, {resizesText(1)}), controlled(GLFW_KEY_MINUS, kEither, {resizesText(-1)}),
        controlled(GLFW_KEY_0, kEither, {resizesText(0)})}},
      {all, "F11", "full screen, and back", {plain(GLFW_KEY_F11, {switches(&ViewSettings::fullScreen)})}},
      {others, "H", "this help, which searches", {plain(GLFW_KEY_H, {switches(&ViewSettings::help)})}},
      {all,
       "F1, ?",
       "this help, which searches",
       {plain(GLFW_KEY_F1, {switches(&ViewSettings::help)}), plain(GLFW_KEY_SLASH, {switches(&ViewSettings::help)})}},
      {all, "Q", "quit", {{GLFW_KEY_Q, kEither, kEither, {WindowCommand::quit}}}},
  };
}

}  // namespace

bool KeyRow::appliesTo(WindowTool tool) const { return std::ranges::find(tools, tool) != tools.end(); }

const std::vector<KeyRow>& keyRows() {
  static const std::vector<KeyRow> kRows = make();
  return kRows;
}

}  // namespace palpate

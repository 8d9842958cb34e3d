#define GLFW_INCLUDE_NONE
#include "apps/view/keyboard.hpp"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "haptics/session/settings.hpp"

namespace palpate {

namespace {

// Resizes the brush by one press of [ or ].
void resize(double& radius_mm, double factor) {
  const Range& range = settingNamed<BrushConfig>("radius_mm").slider;
  radius_mm = std::clamp(radius_mm * factor, range.min, range.max);
}

}  // namespace

bool Keyboard::note(const KeyEvent& event) {
  if (event.key < 0 || static_cast<std::size_t>(event.key) >= down_.size()) return false;
  return std::exchange(down_[static_cast<std::size_t>(event.key)], event.down) == event.down;
}

bool Keyboard::isShiftDown() const { return down_[GLFW_KEY_LEFT_SHIFT] || down_[GLFW_KEY_RIGHT_SHIFT]; }

bool Keyboard::isControlDown() const { return down_[GLFW_KEY_LEFT_CONTROL] || down_[GLFW_KEY_RIGHT_CONTROL]; }

ViewCommands Keyboard::bound(int key) const {
  struct Binding {
    int key;
    bool control;
    std::optional<bool> shift;  // empty: with or without
    ViewCommand command;
  };
  static const Binding kBindings[] = {{GLFW_KEY_Z, true, false, ModelCommand::undo},
                                      {GLFW_KEY_Z, true, true, ModelCommand::redo},
                                      {GLFW_KEY_Y, true, {}, ModelCommand::redo},
                                      {GLFW_KEY_S, true, false, ModelCommand::save},
                                      {GLFW_KEY_S, true, true, BrowseCommand{FileTask::saveAs}},
                                      {GLFW_KEY_O, true, {}, BrowseCommand{FileTask::open}},
                                      {GLFW_KEY_C, true, {}, WindowCommand::copyPlaces},
                                      {GLFW_KEY_Q, true, {}, WindowCommand::quit},
                                      {GLFW_KEY_Q, false, {}, WindowCommand::quit},
                                      {GLFW_KEY_R, false, {}, WindowCommand::resetView},
                                      {GLFW_KEY_U, false, {}, WindowCommand::turnModel},
                                      {GLFW_KEY_P, false, {}, WindowCommand::screenshot},
                                      {GLFW_KEY_K, false, {}, ModelCommand::pause},
                                      {GLFW_KEY_PERIOD, false, {}, ModelCommand::step},
                                      {GLFW_KEY_N, false, {}, ModelCommand::restart},
                                      {GLFW_KEY_BACKSPACE, false, {}, WindowCommand::switchForces},
                                      {GLFW_KEY_T, false, {}, StylusCommand::lockOrUnlock},
                                      {GLFW_KEY_ESCAPE, false, {}, WindowCommand::stopReading},
                                      {GLFW_KEY_ESCAPE, false, {}, StylusCommand::putAway},
                                      {GLFW_KEY_ESCAPE, false, {}, WindowCommand::closeErrors},
                                      {GLFW_KEY_ESCAPE, false, {}, WindowCommand::forgetMeasure}};
  ViewCommands commands;
  for (const Binding& each : kBindings)
    if (each.key == key && each.control == isControlDown() && each.shift.value_or(isShiftDown()) == isShiftDown())
      commands.push_back(each.command);
  return commands;
}

ViewCommands Keyboard::commandsOf(const KeyEvent& event, bool repeats, WindowSettings& settings) const {
  const int key = event.key;
  if (key == GLFW_KEY_SPACE && repeats) return {};
  if (key == GLFW_KEY_SPACE) return {event.down ? StylusCommand::hold : StylusCommand::letGo};
  if (!event.down) return {};
  const auto side = static_cast<std::size_t>(key - GLFW_KEY_1);
  if (isControlDown() && key >= GLFW_KEY_1 && side < kModelSides.size()) return {kModelSides[side].second};
  if (!isControlDown()) change(key, settings);
  if (!isControlDown() && key >= GLFW_KEY_X && key <= GLFW_KEY_Z) return {LookAlong{key - GLFW_KEY_X, isShiftDown()}};
  return bound(key);
}

void Keyboard::change(int key, WindowSettings& settings) {
  constexpr double kRadiusStep = 1.1;
  ViewSettings& view = settings.view;
  switch (key) {
    case GLFW_KEY_ESCAPE:
      view.help = view.measures = false;
      break;
    case GLFW_KEY_H:
      view.help = !view.help;
      break;
    case GLFW_KEY_TAB:
      view.panels = !view.panels;
      break;
    case GLFW_KEY_C:
      view.plots = !view.plots;
      break;
    case GLFW_KEY_F:
      view.cameras = !view.cameras;
      break;
    case GLFW_KEY_D:
      view.measures = !view.measures;
      break;
    case GLFW_KEY_M:
      view.mesh = !view.mesh;
      break;
    case GLFW_KEY_LEFT_BRACKET:
      resize(settings.brush.radius_mm, 1 / kRadiusStep);
      break;
    case GLFW_KEY_RIGHT_BRACKET:
      resize(settings.brush.radius_mm, kRadiusStep);
      break;
    default:
      const int number = key - GLFW_KEY_1;  // 0: feel
      if (number < 0 || number > static_cast<int>(kBrushes.size())) break;
      settings.brush.sculpts = number > 0;
      if (number > 0) settings.brush.kind = kBrushes[static_cast<std::size_t>(number - 1)].kind;
  }
}

}  // namespace palpate

#define GLFW_INCLUDE_NONE
#include "apps/view/keyboard.hpp"

#include <GLFW/glfw3.h>

#include <algorithm>
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

ViewRequests Keyboard::requestsOf(const KeyEvent& event, bool repeats, WindowSettings& settings) const {
  if (event.key == GLFW_KEY_SPACE) {
    if (repeats) return {};
    return {.stylus = event.down ? StylusRequest::hold : StylusRequest::letGo};
  }
  if (!event.down) return {};
  return isControlDown() ? withControl(event.key) : alone(event.key, settings);
}

ViewRequests Keyboard::withControl(int key) const {
  const bool shift = isShiftDown();
  const auto side = static_cast<std::size_t>(key - GLFW_KEY_1);
  return {
      .undo = key == GLFW_KEY_Z && !shift,
      .redo = (key == GLFW_KEY_Z && shift) || key == GLFW_KEY_Y,
      .save = key == GLFW_KEY_S && !shift,
      .quit = key == GLFW_KEY_Q,
      .side = key >= GLFW_KEY_1 && side < kModelSides.size() ? std::optional(kModelSides[side].second) : std::nullopt,
      .copyPlaces = key == GLFW_KEY_C,
      .browse = key == GLFW_KEY_O            ? std::optional(FileTask::open)
                : key == GLFW_KEY_S && shift ? std::optional(FileTask::saveAs)
                                             : std::nullopt};
}

ViewRequests Keyboard::alone(int key, WindowSettings& settings) const {
  constexpr double kRadiusStep = 1.1;
  ViewSettings& view = settings.view;
  switch (key) {
    case GLFW_KEY_X:
    case GLFW_KEY_Y:
    case GLFW_KEY_Z:
      return {.axis = key - GLFW_KEY_X, .fromBehind = isShiftDown()};
    case GLFW_KEY_R:
      return {.resetView = true};
    case GLFW_KEY_P:
      return {.screenshot = true};
    case GLFW_KEY_K:
      return {.holdFrames = true};
    case GLFW_KEY_PERIOD:
      return {.stepFrame = true};
    case GLFW_KEY_N:
      return {.restart = true};
    case GLFW_KEY_Q:
      return {.quit = true};
    case GLFW_KEY_BACKSPACE:
      return {.switchForces = true};
    case GLFW_KEY_T:
      return {.stylus = StylusRequest::lockOrUnlock};
    case GLFW_KEY_ESCAPE:
      view.help = view.measures = false;
      return {.closeErrors = true, .forgetMeasure = true, .stylus = StylusRequest::putAway};
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
      if (key == GLFW_KEY_1) settings.brush.kind.reset();
      if (key > GLFW_KEY_1 && key <= GLFW_KEY_1 + static_cast<int>(kBrushKinds.size()))
        settings.brush.kind = kBrushKinds[static_cast<std::size_t>(key - GLFW_KEY_1 - 1)].second;
  }
  return {};
}

}  // namespace palpate

// The part of Viewer that follows the brush: its keys, the drag of its size, its stroke.
#include <GLFW/glfw3.h>

#include "apps/view/viewer.hpp"
#include "engine/core/error.hpp"

namespace palpate {

bool Viewer::isSculpting() {
  const WindowSession* session = document_.session();
  if (!session || document_.isGivingWay()) return false;
  const auto& ticks = session->recentTicks().rows();
  return session->isDrawing() || (pointing_.isTouching() && !ticks.empty() && ticks.back().contact);
}

// A stroke keeps the keys with which it began.
BrushSettings Viewer::brushInHand() {
  if (!isSculpting()) {
    const bool isHeld = pointing_.isTouching() && settings_.tool == WindowTool::sculpt && !gui_.wantsKeys();
    inHand_.follow({isHeld && keyboard_.isShiftDown(), isHeld && keyboard_.isControlDown()});
  }
  return inHand_.brushFrom(settings_.brush);
}

BrushHint Viewer::brushHint() {
  if (settings_.tool != WindowTool::sculpt || document_.asks() || !document_.session()) return {};
  return inHand_.hint(settings_.brush, settings_.view, pointing_.cursor_px(), !gui_.wantsMouse() && !isSculpting(),
                      pointed());
}

// Returns whether the event was for the drag of the brush.
bool Viewer::dragBrush(const WindowEvent& event, bool repeats) {
  if (!inHand_.isDragging()) return false;
  if (const auto* mouse = std::get_if<MouseEvent>(&event)) inHand_.moveTo(mouse->place_px, settings_.brush);
  const auto* key = std::get_if<KeyEvent>(&event);
  const auto* button = std::get_if<ButtonEvent>(&event);
  const bool isPressed = (key && key->down && !repeats) || (button && button->down);
  if (!isPressed) return button || key;
  if ((key && key->key == GLFW_KEY_ESCAPE) || (button && button->button == MouseButton::right))
    inHand_.giveUp(settings_.brush);
  else if (button || key->key == GLFW_KEY_F || key->key == GLFW_KEY_ENTER || key->key == GLFW_KEY_KP_ENTER)
    inHand_.accept();
  return true;
}

// Returns whether the command has done something.
bool Viewer::carryOut(BrushCommand command) {
  WindowSession* session = document_.session();
  if (!session || document_.isGivingWay()) return false;
  if (command != BrushCommand::cancelStroke) {
    if (!settings_.brush.sculpts) throw Error("choose a brush first (2 to {})", kBrushes.size() + 1);
    if (isSculpting()) return false;
    inHand_.begin(command == BrushCommand::dragSize ? BrushInHand::Drag::size : BrushInHand::Drag::strength,
                  pointing_.cursor_px(), settings_.brush, pointed());
    return true;
  }
  if (!isSculpting() || !session->cancelStroke()) return false;
  pointing_.endStroke(pointed());
  messages_.say("the stroke was taken back");
  return true;
}

}  // namespace palpate

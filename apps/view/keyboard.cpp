#define GLFW_INCLUDE_NONE
#include "apps/view/keyboard.hpp"

#include <GLFW/glfw3.h>

#include <utility>

#include "apps/view/key_table.hpp"

namespace palpate {

bool Keyboard::note(const KeyEvent& event) {
  if (event.key < 0 || static_cast<std::size_t>(event.key) >= down_.size()) return false;
  return std::exchange(down_[static_cast<std::size_t>(event.key)], event.down) == event.down;
}

bool Keyboard::isShiftDown() const { return down_[GLFW_KEY_LEFT_SHIFT] || down_[GLFW_KEY_RIGHT_SHIFT]; }

bool Keyboard::isControlDown() const { return down_[GLFW_KEY_LEFT_CONTROL] || down_[GLFW_KEY_RIGHT_CONTROL]; }

bool Keyboard::isAltDown() const { return down_[GLFW_KEY_LEFT_ALT] || down_[GLFW_KEY_RIGHT_ALT]; }

ViewCommands Keyboard::commandsOf(const KeyEvent& event, bool repeats, WindowSettings& settings) const {
  ViewCommands commands;
  const WindowTool tool = settings.tool;
  for (const KeyRow& row : keyRows()) {
    if (!row.appliesTo(tool)) continue;
    for (const KeyBinding& binding : row.bindings) {
      if (!binding.matches(event.key, isControlDown(), isShiftDown())) continue;
      if (repeats && !binding.release.empty()) continue;  // it is held
      for (const KeyAction& action : event.down ? binding.press : binding.release) {
        if (const auto* command = std::get_if<ViewCommand>(&action)) commands.push_back(*command);
        if (const auto* set = std::get_if<std::function<void(WindowSettings&)>>(&action)) (*set)(settings);
      }
    }
  }
  return commands;
}

}  // namespace palpate

// The keys and the mouse of the window, by tool: what each does, for the window and for its help.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "apps/view/commands.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

/// Posts a command, or changes settings.
using KeyAction = std::variant<ViewCommand, std::function<void(WindowSettings&)>>;

/// A key of the window; `key`: GLFW key number.
struct KeyBinding {
  int key = 0;
  std::optional<bool> control, shift;  ///< empty: with or without
  std::vector<KeyAction> press, release = {};

  bool matches(int pressed, bool isControl, bool isShift) const {
    return key == pressed && control.value_or(isControl) == isControl && shift.value_or(isShift) == isShift;
  }
};

/// A row of the help, with its keys; a row of the mouse is without.
struct KeyRow {
  std::vector<WindowTool> tools;  ///< with which it applies
  std::string keys, effect;
  std::vector<KeyBinding> bindings = {};

  bool appliesTo(WindowTool tool) const;
};

/// With each tool a key together with Ctrl and Shift has one meaning.
const std::vector<KeyRow>& keyRows();

}  // namespace palpate

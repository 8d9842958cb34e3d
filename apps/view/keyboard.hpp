// Pressed keys, and the commands that they post.
#pragma once

#include <array>

#include "apps/view/commands.hpp"
#include "apps/view/events.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

class Keyboard {
 public:
  /// Notes the state of the key. Returns whether it is unchanged, as in a key repeat.
  bool note(const KeyEvent& event);
  /// Commands of a key event with the present tool (keyRows()); keys that only change a setting change it directly.
  ViewCommands commandsOf(const KeyEvent& event, bool repeats, WindowSettings& settings) const;
  bool isShiftDown() const;
  bool isControlDown() const;
  bool isAltDown() const;

 private:
  std::array<bool, 512> down_{};
};

}  // namespace palpate

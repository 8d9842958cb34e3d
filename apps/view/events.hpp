// Events of a window: from the window system, or from a script.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// `key`: GLFW key number.
struct KeyEvent {
  int key = 0;
  bool down = false;
};
struct TextEvent {
  char32_t character = 0;
};
/// Pixels of the picture from the top left corner.
struct MouseEvent {
  DVec2 place_px{0};
};
enum class MouseButton { left, right, middle };
struct ButtonEvent {
  MouseButton button = MouseButton::left;
  bool down = false;
};
/// Notches: away from the user, and to the right.
struct WheelEvent {
  double away = 0, right = 0;
};
struct DropEvent {
  std::vector<std::string> files;
};
/// State of a 3D mouse until the next event: push and rotation of its cap, -1 to 1 (HidMotion), and its buttons.
struct PushEvent {
  DVec3 push{0}, turn{0};
  std::uint32_t buttons = 0;
  bool operator==(const PushEvent&) const = default;
};
struct CloseEvent {};
/// The display has lost the picture of the window.
struct ExposeEvent {};

using WindowEvent = std::variant<KeyEvent, TextEvent, MouseEvent, ButtonEvent, WheelEvent, DropEvent, PushEvent,
                                 CloseEvent, ExposeEvent>;

/// An event and its time, s: of the script, or of the machine.
struct TimedEvent {
  double time_s = 0;
  WindowEvent event;
};

}  // namespace palpate

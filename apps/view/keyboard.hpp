// Pressed keys, and the requests that they make.
#pragma once

#include <array>

#include "apps/view/events.hpp"
#include "apps/view/requests.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

class Keyboard {
 public:
  /// Notes the state of the key. Returns whether it is unchanged, as in a key repeat.
  bool note(const KeyEvent& event);
  /// Requests of a key event; keys that only change a setting change it directly.
  ViewRequests requestsOf(const KeyEvent& event, bool repeats, WindowSettings& settings) const;
  bool isShiftDown() const;

 private:
  bool isControlDown() const;
  ViewRequests withControl(int key) const;
  ViewRequests alone(int key, WindowSettings& settings) const;

  std::array<bool, 512> down_{};
};

}  // namespace palpate

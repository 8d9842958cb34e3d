// Which keys are down, and what they ask for.
#pragma once

#include <array>

#include "apps/view/events.hpp"
#include "apps/view/requests.hpp"
#include "apps/view/settings.hpp"

namespace palpate {

class Keyboard {
 public:
  /// Notes where the key is now. Whether it has been there before, as one has that repeats.
  bool note(const KeyEvent& event);
  /// What a person means by it; settings that have no more to it are turned at once.
  ViewRequests requestsOf(const KeyEvent& event, bool repeats, WindowSettings& settings) const;
  bool isShiftDown() const;

 private:
  bool isControlDown() const;
  ViewRequests withControl(int key) const;
  ViewRequests alone(int key, WindowSettings& settings) const;

  std::array<bool, 512> down_{};
};

}  // namespace palpate

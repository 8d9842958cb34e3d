#include "apps/view/screen_places.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

namespace {

// Length of what two intervals share; negative: minus the gap between them.
long long overlap(int a, int aLength, int b, int bLength) {
  using Wide = long long;
  return std::min(Wide{a} + aLength, Wide{b} + bLength) - std::max(a, b);
}

int within(int from, int length, int screen, int screenLength) {
  return std::clamp(from, screen, std::max(screen, screen + screenLength - length));
}

}  // namespace

std::optional<std::size_t> screenOf(const DesktopPlace& window, std::span<const DesktopPlace> screens) {
  const auto shows = [&](const DesktopPlace& screen) {
    const long long across = overlap(window.left, window.width, screen.left, screen.width);
    const long long down = overlap(window.top, window.height, screen.top, screen.height);
    return across > 0 && down > 0 ? std::pair(across * down, 0LL)
                                  : std::pair(0LL, std::min({across, down, across + down}));
  };
  if (screens.empty()) return std::nullopt;
  return static_cast<std::size_t>(std::ranges::max_element(screens, {}, shows) - screens.begin());
}

DesktopPlace onScreen(const DesktopPlace& window, std::span<const DesktopPlace> screens) {
  const auto number = screenOf(window, screens);
  if (!number) return window;
  const DesktopPlace& screen = screens[*number];
  DesktopPlace place = window;
  place.width = std::min(window.width, screen.width);
  place.height = std::min(window.height, screen.height);
  place.left = within(window.left, place.width, screen.left, screen.width);
  place.top = within(window.top, place.height, screen.top, screen.height);
  return place;
}

}  // namespace palpate

// Where the window is among the screens of a desktop.
#pragma once

#include <optional>
#include <span>

namespace palpate {

/// A screen, or the inside of a window: units of the window system, y downwards.
struct DesktopPlace {
  int left = 0, top = 0, width = 0, height = 0;
  bool operator==(const DesktopPlace&) const = default;
};

/// Number of the screen that shows most of `window`, else of the nearest one; empty: there are no screens.
std::optional<std::size_t> screenOf(const DesktopPlace& window, std::span<const DesktopPlace> screens);
/// The place nearest to `window`, and no larger than the screen, at which that screen shows all of it.
DesktopPlace onScreen(const DesktopPlace& window, std::span<const DesktopPlace> screens);

}  // namespace palpate

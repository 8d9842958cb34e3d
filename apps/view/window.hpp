#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "apps/view/events.hpp"
#include "apps/view/screen_places.hpp"
#include "engine/gpu/device.hpp"

struct GLFWwindow;

namespace palpate {

/// State of a gamepad: sticks -1 to 1 (right and up are positive), triggers 0 to 1.
struct Gamepad {
  DVec2 left{0}, right{0};
  double leftTrigger = 0, rightTrigger = 0;
  bool a = false, b = false;
};

/// The window system, and one window on it. Throws Error without a display.
class Window {
 public:
  /// An invisible window only serves to query presentation support. `at`: in place of the size, brought onto a screen.
  explicit Window(const UVec2& size_px, const std::string& title, bool visible = true,
                  const std::optional<DesktopPlace>& at = {});
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Instance extensions that surface() requires; empty where the window system cannot present from Vulkan.
  std::vector<std::string> extensions() const;
  VkSurfaceKHR surface(const Instance& instance) const;
  GLFWwindow* handle() const { return window_; }

  /// Events since the last call; waits up to `wait_s` for one.
  std::vector<WindowEvent> takeEvents(double wait_s = 0);
  /// Size of the framebuffer; zero on a side while the window is minimised.
  UVec2 size_px() const;
  bool isMinimised() const;
  void resize(const UVec2& size_px);
  void minimise(bool on);
  /// Of its inside, as a window; empty: full screen, minimised, or the window system does not tell.
  std::optional<DesktopPlace> place() const;
  /// Covers the screen that shows most of it, or is a window again where it was.
  void setFullScreen(bool on);
  void setTitle(const std::string& title);
  /// Shows or hides the window system's cursor.
  void showCursor(bool on);
  std::optional<Gamepad> gamepad() const;
  std::string clipboard() const;
  void setClipboard(const std::string& text);
  /// Framebuffer pixels per layout unit of the panels.
  double scale() const;

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<WindowEvent> events_;
  std::optional<DesktopPlace> windowed_;  // before full screen; empty: it is not
};

/// GLFW number of a key by its name in a script ("z", "space", "ctrl", "left", "f1", …), case-insensitive; nothing for
/// an unknown name.
std::optional<int> keyNamed(std::string_view name);
/// All key names, in one line.
std::string keyNames();

}  // namespace palpate

#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "apps/view/events.hpp"
#include "engine/gpu/device.hpp"

struct GLFWwindow;

namespace palpate {

/// What a gamepad says: sticks -1 to 1 (right and up are positive), triggers 0 to 1.
struct Gamepad {
  DVec2 left{0}, right{0};
  double leftTrigger = 0, rightTrigger = 0;
  bool a = false, b = false;
};

/// The window system, and one window on it. Throws Error where there is no display.
class Window {
 public:
  /// One that is not visible only tells what could be shown.
  Window(const UVec2& size_px, const std::string& title, bool visible = true);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// The instance extensions that surface() needs; none where there is no way to show pictures of Vulkan.
  std::vector<std::string> extensions() const;
  VkSurfaceKHR surface(const Instance& instance) const;
  GLFWwindow* handle() const { return window_; }

  /// What has happened since the last call; waits for something for `wait_s` at most.
  std::vector<WindowEvent> takeEvents(double wait_s = 0);
  /// Of the picture; zero on a side while the window is minimised.
  UVec2 size_px() const;
  bool isMinimised() const;
  void resize(const UVec2& size_px);
  void minimise(bool on);
  void setTitle(const std::string& title);
  /// The window system's own cursor.
  void showCursor(bool on);
  std::optional<Gamepad> gamepad() const;
  std::string clipboard() const;
  void setClipboard(const std::string& text);
  /// Pixels of the picture for each unit that a panel is laid out in.
  double scale() const;

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<WindowEvent> events_;
};

/// The number of a key by its name in a script ("z", "space", "ctrl", "left", "f1", …), in any case; nothing for an
/// unknown one.
std::optional<int> keyNamed(std::string_view name);
/// All of them, in a line.
std::string keyNames();

}  // namespace palpate

#include "apps/view/window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>
#include <string>
#include <utility>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

// The reason is included if the environment names a display.
Error noDisplay() {
  const char* reason = nullptr;
  glfwGetError(&reason);
  std::string why = reason ? reason : "";
  while (why.ends_with(' ')) why.pop_back();
  const bool isNamed = std::getenv("DISPLAY") || std::getenv("WAYLAND_DISPLAY");
  return Error("a window needs a display, and none was found{}; palpate render makes a picture without one",
               isNamed && !why.empty() ? fmt::format(" ({})", why) : "");
}

std::vector<WindowEvent>& eventsOf(GLFWwindow* window) {
  return *static_cast<std::vector<WindowEvent>*>(glfwGetWindowUserPointer(window));
}

// Framebuffer pixels per unit of the window system.
DVec2 pixelsPerUnit(GLFWwindow* window) {
  int width = 0, height = 0, across = 0, down = 0;
  glfwGetWindowSize(window, &width, &height);
  glfwGetFramebufferSize(window, &across, &down);
  return width > 0 && height > 0 ? DVec2(double(across) / width, double(down) / height) : DVec2(1);
}

std::optional<MouseButton> buttonOf(int number) {
  if (number == GLFW_MOUSE_BUTTON_LEFT) return MouseButton::left;
  if (number == GLFW_MOUSE_BUTTON_RIGHT) return MouseButton::right;
  if (number == GLFW_MOUSE_BUTTON_MIDDLE) return MouseButton::middle;
  return std::nullopt;
}

std::span<GLFWmonitor* const> monitors() {
  int count = 0;
  GLFWmonitor* const* const all = glfwGetMonitors(&count);
  return {all, static_cast<std::size_t>(count)};
}

// Of each monitor what no bar of the desktop covers.
std::vector<DesktopPlace> screens() {
  std::vector<DesktopPlace> places;
  for (GLFWmonitor* const monitor : monitors()) {
    DesktopPlace& place = places.emplace_back();
    glfwGetMonitorWorkarea(monitor, &place.left, &place.top, &place.width, &place.height);
  }
  return places;
}

void listen(GLFWwindow* window) {
  glfwSetKeyCallback(window, [](GLFWwindow* from, int key, int scanCode, int action, int) {
    // Letters by the user's keyboard layout, not by the US layout.
    const char* name = glfwGetKeyName(key, scanCode);
    if (name && name[0] >= 'a' && name[0] <= 'z' && name[1] == 0) key = GLFW_KEY_A + (name[0] - 'a');
    if (key >= 0) eventsOf(from).push_back(KeyEvent{key, action != GLFW_RELEASE});
  });
  glfwSetCharCallback(window, [](GLFWwindow* from, unsigned character) {
    eventsOf(from).push_back(TextEvent{static_cast<char32_t>(character)});
  });
  glfwSetCursorPosCallback(window, [](GLFWwindow* from, double x, double y) {
    eventsOf(from).push_back(MouseEvent{pixelsPerUnit(from) * DVec2(x, y)});
  });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* from, int number, int action, int) {
    if (const auto button = buttonOf(number)) eventsOf(from).push_back(ButtonEvent{*button, action == GLFW_PRESS});
  });
  glfwSetScrollCallback(window, [](GLFWwindow* from, double right, double away) {
    eventsOf(from).push_back(WheelEvent{away, right});
  });
  glfwSetDropCallback(window, [](GLFWwindow* from, int count, const char** files) {
    eventsOf(from).push_back(DropEvent{{files, files + count}});
  });
  glfwSetWindowRefreshCallback(window, [](GLFWwindow* from) { eventsOf(from).push_back(ExposeEvent{}); });
  glfwSetWindowCloseCallback(window, [](GLFWwindow* from) { eventsOf(from).push_back(CloseEvent{}); });
}

}  // namespace

Window::Window(const UVec2& size_px, const std::string& title, bool visible, const std::optional<DesktopPlace>& at) {
  if (!glfwInit()) throw noDisplay();
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  glfwWindowHint(GLFW_VISIBLE, visible && !at ? GLFW_TRUE : GLFW_FALSE);
  const DesktopPlace place =
      at ? onScreen(*at, screens()) : DesktopPlace{0, 0, static_cast<int>(size_px.x), static_cast<int>(size_px.y)};
  window_ = glfwCreateWindow(place.width, place.height, title.c_str(), nullptr, nullptr);
  if (!window_) {
    const Error error = noDisplay();
    glfwTerminate();
    throw error;
  }
  glfwSetWindowUserPointer(window_, &events_);
  listen(window_);
  if (!at) return;
  glfwSetWindowPos(window_, place.left, place.top);
  if (visible) glfwShowWindow(window_);
}

Window::~Window() {
  glfwDestroyWindow(window_);
  glfwTerminate();
}

std::vector<std::string> Window::extensions() const {
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (!names) return {};
  return {names, names + count};
}

VkSurfaceKHR Window::surface(const Instance& instance) const {
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  checkVk(glfwCreateWindowSurface(instance.handle(), window_, nullptr, &surface), "glfwCreateWindowSurface", "GLFW");
  return surface;
}

std::vector<WindowEvent> Window::takeEvents(double wait_s) {
  if (wait_s > 0)
    glfwWaitEventsTimeout(wait_s);
  else
    glfwPollEvents();
  return std::exchange(events_, {});
}

UVec2 Window::size_px() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return isMinimised() ? UVec2(0) : UVec2(std::max(width, 0), std::max(height, 0));
}

bool Window::isMinimised() const { return glfwGetWindowAttrib(window_, GLFW_ICONIFIED) == GLFW_TRUE; }

void Window::resize(const UVec2& size_px) {
  const DVec2 units = DVec2(size_px) / pixelsPerUnit(window_);
  glfwSetWindowSize(window_, static_cast<int>(units.x), static_cast<int>(units.y));
}

void Window::minimise(bool on) { on ? glfwIconifyWindow(window_) : glfwRestoreWindow(window_); }

void Window::setFullScreen(bool on) {
  if (on == windowed_.has_value()) return;
  if (!on) {
    const DesktopPlace to = onScreen(*std::exchange(windowed_, {}), screens());
    return glfwSetWindowMonitor(window_, nullptr, to.left, to.top, to.width, to.height, GLFW_DONT_CARE);
  }
  windowed_.emplace();
  glfwGetWindowPos(window_, &windowed_->left, &windowed_->top);
  glfwGetWindowSize(window_, &windowed_->width, &windowed_->height);
  const auto number = screenOf(*windowed_, screens());
  GLFWmonitor* const monitor = number ? monitors()[*number] : nullptr;
  if (const GLFWvidmode* const mode = monitor ? glfwGetVideoMode(monitor) : nullptr)
    glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

std::optional<DesktopPlace> Window::place() const {
  if (windowed_ || isMinimised()) return std::nullopt;
  DesktopPlace place;
  glfwGetError(nullptr);
  glfwGetWindowPos(window_, &place.left, &place.top);
  glfwGetWindowSize(window_, &place.width, &place.height);
  return glfwGetError(nullptr) == GLFW_NO_ERROR ? std::optional(place) : std::nullopt;
}

void Window::setTitle(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

void Window::showCursor(bool on) {
  glfwSetInputMode(window_, GLFW_CURSOR, on ? GLFW_CURSOR_NORMAL : GLFW_CURSOR_HIDDEN);
}

std::optional<Gamepad> Window::gamepad() const {
  GLFWgamepadstate state;
  for (int number = GLFW_JOYSTICK_1; number <= GLFW_JOYSTICK_LAST; ++number) {
    if (!glfwJoystickIsGamepad(number) || !glfwGetGamepadState(number, &state)) continue;
    const auto trigger = [&](int axis) { return 0.5 * (1 + double{state.axes[axis]}); };
    return Gamepad{.left = {state.axes[GLFW_GAMEPAD_AXIS_LEFT_X], -state.axes[GLFW_GAMEPAD_AXIS_LEFT_Y]},
                   .right = {state.axes[GLFW_GAMEPAD_AXIS_RIGHT_X], -state.axes[GLFW_GAMEPAD_AXIS_RIGHT_Y]},
                   .leftTrigger = trigger(GLFW_GAMEPAD_AXIS_LEFT_TRIGGER),
                   .rightTrigger = trigger(GLFW_GAMEPAD_AXIS_RIGHT_TRIGGER),
                   .a = state.buttons[GLFW_GAMEPAD_BUTTON_A] == GLFW_PRESS,
                   .b = state.buttons[GLFW_GAMEPAD_BUTTON_B] == GLFW_PRESS};
  }
  return std::nullopt;
}

std::string Window::clipboard() const {
  const char* text = glfwGetClipboardString(window_);
  return text ? text : "";
}

void Window::setClipboard(const std::string& text) { glfwSetClipboardString(window_, text.c_str()); }

double Window::scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::max(1.0, 0.5 * double(x + y));
}

namespace {

// In addition to letters and digits.
constexpr std::array<std::pair<std::string_view, int>, 24> kKeyNames{{{"space", GLFW_KEY_SPACE},
                                                                      {"escape", GLFW_KEY_ESCAPE},
                                                                      {"enter", GLFW_KEY_ENTER},
                                                                      {"tab", GLFW_KEY_TAB},
                                                                      {"backspace", GLFW_KEY_BACKSPACE},
                                                                      {"delete", GLFW_KEY_DELETE},
                                                                      {"left", GLFW_KEY_LEFT},
                                                                      {"right", GLFW_KEY_RIGHT},
                                                                      {"up", GLFW_KEY_UP},
                                                                      {"down", GLFW_KEY_DOWN},
                                                                      {"home", GLFW_KEY_HOME},
                                                                      {"end", GLFW_KEY_END},
                                                                      {"pageup", GLFW_KEY_PAGE_UP},
                                                                      {"pagedown", GLFW_KEY_PAGE_DOWN},
                                                                      {"ctrl", GLFW_KEY_LEFT_CONTROL},
                                                                      {"shift", GLFW_KEY_LEFT_SHIFT},
                                                                      {"alt", GLFW_KEY_LEFT_ALT},
                                                                      {"[", GLFW_KEY_LEFT_BRACKET},
                                                                      {"]", GLFW_KEY_RIGHT_BRACKET},
                                                                      {"+", GLFW_KEY_EQUAL},
                                                                      {"-", GLFW_KEY_MINUS},
                                                                      {",", GLFW_KEY_COMMA},
                                                                      {".", GLFW_KEY_PERIOD},
                                                                      {"/", GLFW_KEY_SLASH}}};

char lowered(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

std::optional<int> keyNamed(std::string_view name) {
  std::string lower(name);
  std::ranges::transform(lower, lower.begin(), lowered);
  const auto known = std::ranges::find(kKeyNames, lower, &std::pair<std::string_view, int>::first);
  if (known != kKeyNames.end()) return known->second;
  constexpr int kFunctionKeys = 12;
  for (int k = 0; k < kFunctionKeys; ++k)
    if (lower == "f" + std::to_string(k + 1)) return GLFW_KEY_F1 + k;
  if (lower.size() != 1) return std::nullopt;
  const char c = lower[0];
  if (c >= 'a' && c <= 'z') return GLFW_KEY_A + (c - 'a');
  if (c >= '0' && c <= '9') return GLFW_KEY_0 + (c - '0');
  return std::nullopt;
}

std::string keyNames() {
  std::string all = "a to z 0 to 9 f1 to f12";
  for (const auto& [name, key] : kKeyNames) all.append(" ").append(name);
  return all;
}

}  // namespace palpate

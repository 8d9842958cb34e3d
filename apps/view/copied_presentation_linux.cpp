#include <dlfcn.h>

#include "apps/view/copied_pictures.hpp"
#include "apps/view/copied_presentation.hpp"

struct GLFWwindow;

namespace palpate {

namespace {

// Extension of NVIDIA's module in the X server; the driver cannot present without it.
constexpr const char* kNvidiaExtension = "NV-GLX";

// The window's X display and number; nothing for a window of another window system.
std::optional<X11Window> x11Of(const Window& window) {
  // Looked up by name: GLFW built for Wayland has the same library name and lacks these functions.
  const auto display = reinterpret_cast<void* (*)()>(::dlsym(RTLD_DEFAULT, "glfwGetX11Display"));
  const auto number = reinterpret_cast<unsigned long (*)(GLFWwindow*)>(::dlsym(RTLD_DEFAULT, "glfwGetX11Window"));
  if (!display || !number || !display()) return std::nullopt;
  return X11Window{display(), number(window.handle())};
}

}  // namespace

bool takesCopies(const Window& window) { return x11Of(window).has_value(); }

std::unique_ptr<Presenter> copyingPresenter(const Window& window, Device& device, bool waitsForDisplay) {
  const auto x11 = x11Of(window);
  if (!x11) throw Error("pictures are copied only to an X display");
  return std::make_unique<CopiedPictures>(device, *x11, window.size_px(), waitsForDisplay);
}

std::string_view whyNotAskNvidia(const Window& window) {
  const auto x11 = x11Of(window);
  return x11 && !hasXExtension(*x11, kNvidiaExtension)
             ? "the X server has no NV-GLX extension, as usual for remote desktops"
             : "";
}

}  // namespace palpate

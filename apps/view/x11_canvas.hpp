#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "engine/core/vec.hpp"

namespace palpate {

/// Xlib display and window. The display outlives its users.
struct X11Window {
  void* display = nullptr;
  unsigned long window = 0;
};

/// Whether the X server has an extension of that name.
bool hasXExtension(const X11Window& window, const char* name);

/// Writes pixels to an X window, local or remote, of any depth. Throws Error for a display without true colours.
class X11Canvas {
 public:
  explicit X11Canvas(const X11Window& window);
  ~X11Canvas();
  X11Canvas(const X11Canvas&) = delete;
  X11Canvas& operator=(const X11Canvas&) = delete;

  /// Channel order that put() accepts: blue in the lowest byte if true, else red.
  bool blueFirst() const;
  /// Writes 32-bit pixels, row by row from the top. Returns once the server has received them.
  void put(std::span<const std::uint32_t> pixels, const UVec2& size_px);

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace palpate

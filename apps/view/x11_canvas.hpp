#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "engine/core/vec.hpp"

namespace palpate {

/// A window of an X server, as the library that made it (Xlib) knows it. The display outlives whoever uses it.
struct X11Window {
  void* display = nullptr;
  unsigned long window = 0;
};

/// Whether the server has an extension of that name.
bool hasXExtension(const X11Window& window, const char* name);

/// An X window as a place for pixels, near or far, of whatever depth. Throws Error where it has no true colours.
class X11Canvas {
 public:
  explicit X11Canvas(const X11Window& window);
  ~X11Canvas();
  X11Canvas(const X11Canvas&) = delete;
  X11Canvas& operator=(const X11Canvas&) = delete;

  /// Which order put() takes as it is: blue in the lowest byte, or red.
  bool blueFirst() const;
  /// Pixels of 32 bits, row by row from the top. Returns once the server has them.
  void put(std::span<const std::uint32_t> pixels, const UVec2& size_px);

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace palpate

#include "apps/view/x11_canvas.hpp"

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <bit>
#include <vector>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr unsigned long kRed = 0xff0000, kGreen = 0xff00, kBlue = 0xff;  // masks with blue in the lowest byte

Display* displayOf(const X11Window& window) { return static_cast<Display*>(window.display); }

// Converts an 8-bit channel to the bits of `mask`.
unsigned long placed(std::uint32_t value, unsigned long mask) {
  const int bits = std::popcount(mask), at = std::countr_zero(mask);
  return (bits >= 8 ? (static_cast<unsigned long>(value) << (bits - 8)) : (value >> (8 - bits))) << at;
}

}  // namespace

bool hasXExtension(const X11Window& window, const char* name) {
  int code = 0, event = 0, error = 0;
  return XQueryExtension(displayOf(window), name, &code, &event, &error) != 0;
}

struct X11Canvas::Server {
  Display* display = nullptr;
  Window window = 0;
  XWindowAttributes attributes{};
  GC context = nullptr;
  bool blueFirst = true, takesAsIs = false;
  std::vector<char> packed;  // converted pixels, if the server does not accept 32 bits per pixel directly
};

X11Canvas::X11Canvas(const X11Window& window) : server_(std::make_unique<Server>()) {
  Server& x = *server_;
  x.display = displayOf(window);
  x.window = window.window;
  XGetWindowAttributes(x.display, x.window, &x.attributes);
  const Visual& visual = *x.attributes.visual;
  if (visual.c_class != TrueColor)
    throw Error("the display has {} bits per pixel and no true colours; use 16 bits or more", x.attributes.depth);
  XImage* probe = XCreateImage(x.display, x.attributes.visual, static_cast<unsigned>(x.attributes.depth), ZPixmap, 0,
                               nullptr, 1, 1, 32, 0);
  if (!probe) throw Error("the display does not accept pictures of {} bits per pixel", x.attributes.depth);
  x.blueFirst = visual.red_mask != kBlue;
  x.takesAsIs =
      probe->bits_per_pixel == 32 && visual.green_mask == kGreen &&
      (visual.red_mask == kRed ? visual.blue_mask == kBlue : visual.red_mask == kBlue && visual.blue_mask == kRed);
  XDestroyImage(probe);
  x.context = XCreateGC(x.display, x.window, 0, nullptr);
}

X11Canvas::~X11Canvas() { XFreeGC(server_->display, server_->context); }

bool X11Canvas::blueFirst() const { return server_->blueFirst; }

void X11Canvas::put(std::span<const std::uint32_t> pixels, const UVec2& size_px) {
  Server& x = *server_;
  XImage* image = XCreateImage(x.display, x.attributes.visual, static_cast<unsigned>(x.attributes.depth), ZPixmap, 0,
                               nullptr, size_px.x, size_px.y, 32, 0);
  if (!image) throw Error("the display does not accept a picture of {} x {} pixels", size_px.x, size_px.y);
  // The bytes are in the host's order; Xlib swaps them for a server with another order.
  image->byte_order = std::endian::native == std::endian::little ? LSBFirst : MSBFirst;
  if (x.takesAsIs) {
    image->data = reinterpret_cast<char*>(const_cast<std::uint32_t*>(pixels.data()));
  } else {
    const Visual& visual = *x.attributes.visual;
    x.packed.resize(static_cast<std::size_t>(image->bytes_per_line) * size_px.y);
    image->data = x.packed.data();
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const std::uint32_t pixel = pixels[i], low = pixel & 0xff, high = pixel >> 16 & 0xff;
      XPutPixel(image, static_cast<int>(i % size_px.x), static_cast<int>(i / size_px.x),
                placed(x.blueFirst ? high : low, visual.red_mask) | placed(pixel >> 8 & 0xff, visual.green_mask) |
                    placed(x.blueFirst ? low : high, visual.blue_mask));
    }
  }
  XPutImage(x.display, x.window, x.context, image, 0, 0, 0, 0, size_px.x, size_px.y);
  XSync(x.display, False);  // one picture in flight at a time, also on a remote display
  image->data = nullptr;
  XDestroyImage(image);
}

}  // namespace palpate

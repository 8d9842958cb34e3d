#pragma once

#include <functional>

#include "engine/core/vec.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"

namespace palpate {

/// Shows pictures in a window. Used by the thread that shows them.
class Presenter {
 public:
  Presenter(const UVec2& size_px, bool waitsForDisplay) : size_px_(size_px), waitsForDisplay_(waitsForDisplay) {}
  virtual ~Presenter() = default;
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;

  /// Size of the pictures to show; zero on a side while the window is too small.
  const UVec2& size_px() const { return size_px_; }
  /// Whether pixels are stored as BGRA (blue in the lowest byte) instead of RGBA.
  bool blueFirst() const { return blueFirst_; }
  /// Whether a picture lasts for at least one refresh of the display (vsync); otherwise pictures are shown as fast as
  /// they are made, if the display supports it.
  bool waitsForDisplay() const { return waitsForDisplay_; }
  /// Sets the size of the window and whether it waits for the display.
  virtual void change(const UVec2& size_px, bool waitsForDisplay) = 0;

  /// Shows a picture of size_px(): `list` is begun, `record` adds the commands that draw the picture, and it is shown
  /// once they complete. False, with nothing recorded, if the window has changed meanwhile or is not visible: size_px()
  /// is then the new size. waitForLast() waits for the GPU to finish.
  virtual bool show(CommandList& list, const Buffer& picture, const std::function<void()>& record) = 0;
  virtual void waitForLast() = 0;

 protected:
  UVec2 size_px_;
  bool blueFirst_ = false, waitsForDisplay_;
};

}  // namespace palpate

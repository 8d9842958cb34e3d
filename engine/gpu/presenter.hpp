#pragma once

#include <functional>

#include "engine/core/vec.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"

namespace palpate {

/// A way to show pictures in a window, one after the other. Used by the thread that shows them.
class Presenter {
 public:
  Presenter(const UVec2& size_px, bool waitsForDisplay) : size_px_(size_px), waitsForDisplay_(waitsForDisplay) {}
  virtual ~Presenter() = default;
  Presenter(const Presenter&) = delete;
  Presenter& operator=(const Presenter&) = delete;

  /// Of the pictures that are to be shown; zero on a side while the window is too small for any.
  const UVec2& size_px() const { return size_px_; }
  /// Whether red is in the highest byte but one of a pixel, and blue in the lowest.
  bool blueFirst() const { return blueFirst_; }
  /// A picture lasts for at least one refresh of the display; otherwise pictures come as fast as they are made, where
  /// the display can do that.
  bool waitsForDisplay() const { return waitsForDisplay_; }
  /// The window has another size, or waits for the display from now on.
  virtual void change(const UVec2& size_px, bool waitsForDisplay) = 0;

  /// Shows a picture of size_px(): `list` is begun, `record` adds to it what makes the picture, and it is shown once
  /// that is done. False, with nothing recorded, where the window has changed meanwhile, or cannot be seen: size_px()
  /// says what it is now. waitForLast() waits for the GPU to finish.
  virtual bool show(CommandList& list, const Buffer& picture, const std::function<void()>& record) = 0;
  virtual void waitForLast() = 0;

 protected:
  UVec2 size_px_;
  bool blueFirst_ = false, waitsForDisplay_;
};

}  // namespace palpate

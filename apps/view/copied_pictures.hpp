#pragma once

#include <chrono>

#include "apps/view/x11_canvas.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/presenter.hpp"

namespace palpate {

/// Copies pictures to the display through the host's memory: for displays that the GPU cannot present to, such as
/// remote desktops.
class CopiedPictures final : public Presenter {
 public:
  CopiedPictures(Device& device, const X11Window& window, const UVec2& size_px, bool waitsForDisplay);

  void change(const UVec2& size_px, bool waitsForDisplay) override;
  bool show(CommandList& list, const Buffer& picture, const std::function<void()>& record) override;
  void waitForLast() override {}  // show() has waited already

 private:
  Device& device_;
  X11Canvas canvas_;
  Buffer staging_;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace palpate

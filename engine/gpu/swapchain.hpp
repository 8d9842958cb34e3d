#pragma once

#include <optional>
#include <vector>

#include "engine/core/vec.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/queue.hpp"

namespace palpate {

/// A way to show a picture in every frame of a window, on the device's window queue. It follows the window's size by
/// itself. Used by the thread that shows pictures.
class Swapchain {
 public:
  /// Takes the surface over. `waitsForDisplay`: a picture lasts for at least one refresh of the display; otherwise
  /// pictures come as fast as they are made, where the driver can do that. Throws GpuError where the device cannot show
  /// anything on it.
  Swapchain(Device& device, VkSurfaceKHR surface, const UVec2& size_px, bool waitsForDisplay);
  ~Swapchain();
  Swapchain(const Swapchain&) = delete;
  Swapchain& operator=(const Swapchain&) = delete;

  /// Of the pictures that are to be shown; zero on a side while the window is too small for any.
  const UVec2& size_px() const { return size_px_; }
  /// Whether red is in the highest byte but one of a pixel, and blue in the lowest.
  bool blueFirst() const { return blueFirst_; }
  bool waitsForDisplay() const { return waitsForDisplay_; }
  /// The window has another size, or waits for the display from now on.
  void change(const UVec2& size_px, bool waitsForDisplay);

  /// Shows a picture of size_px(): `list` is begun, `record` adds to it what makes the picture, and it is shown once
  /// that is done. False, with nothing recorded, where the window has changed meanwhile, or cannot be seen: size_px()
  /// says what it is now. Does not wait for the GPU to finish; waitForLast() does.
  template <class Record>
  bool show(CommandList& list, const Buffer& picture, Record&& record) {
    const auto image = acquire();
    if (!image) return false;
    list.begin();
    record();
    list.show(picture, images_[*image], size_px_);
    list.end();
    present(list, *image);
    return true;
  }
  void waitForLast();

 private:
  void make();
  void release();
  std::optional<std::uint32_t> acquire();
  void present(const CommandList& list, std::uint32_t image);

  Device& device_;
  VkSurfaceKHR surface_;
  UVec2 wanted_px_, size_px_{0};
  bool blueFirst_ = false, waitsForDisplay_, stale_ = false;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  std::vector<VkImage> images_;
  std::vector<VkSemaphore> drawn_;  // of each image
  VkSemaphore acquired_ = VK_NULL_HANDLE;
  Queue::Ticket last_ = 0;
};

}  // namespace palpate

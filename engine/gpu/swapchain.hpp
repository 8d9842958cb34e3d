#pragma once

#include <optional>
#include <vector>

#include "engine/gpu/presenter.hpp"
#include "engine/gpu/queue.hpp"

namespace palpate {

/// Presentation by the GPU itself, on the device's window queue. Follows the window's size automatically.
class Swapchain final : public Presenter {
 public:
  /// Takes ownership of the surface. Throws GpuError if the device cannot present to it.
  Swapchain(Device& device, VkSurfaceKHR surface, const UVec2& size_px, bool waitsForDisplay);
  ~Swapchain() override;

  void change(const UVec2& size_px, bool waitsForDisplay) override;
  /// Does not wait for the GPU to finish.
  bool show(CommandList& list, const Buffer& picture, const std::function<void()>& record) override;
  void waitForLast() override;

 private:
  void make();
  void release();
  std::optional<std::uint32_t> acquire();
  void present(const CommandList& list, std::uint32_t image);

  Device& device_;
  VkSurfaceKHR surface_;
  UVec2 wanted_px_;
  bool stale_ = false;
  VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
  std::vector<VkImage> images_;
  std::vector<VkSemaphore> drawn_;  // of each image
  VkSemaphore acquired_ = VK_NULL_HANDLE;
  Queue::Ticket last_ = 0;
};

}  // namespace palpate

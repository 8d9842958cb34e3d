#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "engine/core/priority_mutex.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class CommandList;
class Device;

/// How a thread waits for the GPU. Spinning answers soonest and burns a core; polling yields between looks; blocking
/// sleeps in the driver, which is the only fair way where the driver itself needs the cores.
enum class Wait { spin, poll, block };

/// A driver queue. Roles that share one all hold this and its lock.
struct SharedQueue {
  VkQueue handle = VK_NULL_HANDLE;
  PriorityMutex lock;
};

/// Around a submission; null where there is none.
struct Semaphores {
  VkSemaphore waits = VK_NULL_HANDLE;    ///< its copies and shaders wait for this one
  VkSemaphore signals = VK_NULL_HANDLE;  ///< when all of it is done
};

/// One role's way to the GPU: submits in order and says when a submission is done. Used by one thread at a time.
class Queue {
 public:
  /// Identifies one submission; grows by one with each.
  using Ticket = std::uint64_t;

  Queue(Device& device, std::shared_ptr<SharedQueue> queue, std::uint32_t family);
  ~Queue();
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  std::uint32_t family() const { return family_; }
  /// Waits first when too many submissions are in flight.
  Ticket submit(const CommandList& list, const Semaphores& semaphores = {});
  /// Hands an image to the window system once `after` is signalled; what the driver says, where that is no error.
  VkResult present(VkSwapchainKHR swapchain, std::uint32_t image, VkSemaphore after);
  bool canPresent(VkSurfaceKHR surface) const;
  bool isDone(Ticket ticket) const;
  /// True when done, false when `timeout_us` has passed (0: wait for ever). Throws DeviceLost.
  bool wait(Ticket ticket, Wait how = Wait::block, double timeout_us = 0) const;
  void run(const CommandList& list) { wait(submit(list)); }

 private:
  Device& device_;
  std::shared_ptr<SharedQueue> queue_;
  std::uint32_t family_;
  // Fences, not a timeline semaphore: the validation layer of Debian 12 loses track of timelines and waits for seconds.
  static constexpr std::uint64_t kInFlight = 8;
  VkFence fenceOf(Ticket ticket) const { return fences_[ticket % kInFlight]; }
  std::array<VkFence, kInFlight> fences_{};
  Ticket last_ = 0;
  bool broken_ = false;  // a submission failed: its fence will never be signalled
};

}  // namespace palpate

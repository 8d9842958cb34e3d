#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>

#include "engine/core/index_options.hpp"
#include "engine/core/priority_mutex.hpp"
#include "engine/gpu/vulkan.hpp"

namespace palpate {

class CommandList;
class Device;

/// A driver queue. Policies that share one all hold this, and lock it around each submission; where another program
/// uses the queue, too, its lock is taken first (HostDevice).
class SharedQueue {
 public:
  using HostLock = std::function<void(VkQueue)>;

  explicit SharedQueue(VkQueue handle, HostLock lockHost = {}, HostLock unlockHost = {})
      : handle_(handle), lockHost_(std::move(lockHost)), unlockHost_(std::move(unlockHost)) {}

  VkQueue handle() const { return handle_; }
  void lock() {
    if (lockHost_) lockHost_(handle_);
    mutex_.lock();
  }
  void unlock() {
    mutex_.unlock();
    if (unlockHost_) unlockHost_(handle_);
  }

 private:
  VkQueue handle_;
  HostLock lockHost_, unlockHost_;
  PriorityMutex mutex_;
};

/// Around a submission; null where there is none.
struct Semaphores {
  VkSemaphore waits = VK_NULL_HANDLE;    ///< its copies and shaders wait for this one
  VkSemaphore signals = VK_NULL_HANDLE;  ///< when all of it is done
};

/// What a queue is for.
enum class QueuePolicy {
  latency,     ///< short work that somebody waits for: it goes first, and is never cut up
  throughput,  ///< long work that gives way: in slices, while there is urgent work (Device::hasUrgentWork)
  background   ///< work that nobody waits for: it goes last, and in slices as well
};

/// One policy's way to the GPU: submits in order and says when a submission is done. Used by one thread at a time.
class Queue {
 public:
  /// Identifies one submission; grows by one with each.
  using Ticket = std::uint64_t;

  Queue(Device& device, std::shared_ptr<SharedQueue> queue, std::uint32_t family, QueuePolicy policy);
  ~Queue();
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  /// Another way to the same queue of the driver, for another thread. Goes before the device.
  std::unique_ptr<Queue> another() const { return std::make_unique<Queue>(device_, queue_, family_, policy_); }
  std::uint32_t family() const { return family_; }
  QueuePolicy policy() const { return policy_; }
  /// Waits first when too many submissions are in flight.
  Ticket submit(const CommandList& list, const Semaphores& semaphores = {});
  /// Hands an image to the window system once `after` is signalled; what the driver says, where that is no error.
  VkResult present(VkSwapchainKHR swapchain, std::uint32_t image, VkSemaphore after);
  bool canPresent(VkSurfaceKHR surface) const;
  bool isDone(Ticket ticket) const;
  /// True when done, false when `timeout_us` has passed (0: wait for ever). Throws DeviceLost.
  bool wait(Ticket ticket, Wait how = Wait::block, double timeout_us = 0) const;
  void run(const CommandList& list) { wait(submit(list)); }
  /// Waits until all submissions are done.
  void finish() const {
    if (last_ > 0) wait(last_);
  }

 private:
  Device& device_;
  std::shared_ptr<SharedQueue> queue_;
  std::uint32_t family_;
  QueuePolicy policy_;
  // Fences, not a timeline semaphore: the validation layer of Debian 12 loses track of timelines and waits for seconds.
  static constexpr std::uint64_t kInFlight = 8;
  VkFence fenceOf(Ticket ticket) const { return fences_[ticket % kInFlight]; }
  std::array<VkFence, kInFlight> fences_{};
  Ticket last_ = 0;
  bool broken_ = false;  // a submission failed: its fence will never be signalled
};

}  // namespace palpate

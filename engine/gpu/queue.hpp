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

/// A driver queue. Policies with the same queue share this object, and lock it around each submission; if another
/// program uses the queue, too, its lock is taken first (HostDevice).
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

/// Semaphores of a submission; null if unused.
struct Semaphores {
  VkSemaphore waits = VK_NULL_HANDLE;    ///< its copies and shaders wait for this one
  VkSemaphore signals = VK_NULL_HANDLE;  ///< signalled when the submission is complete
};

/// The policy of a queue.
enum class QueuePolicy {
  latency,     ///< short work with a waiting caller: highest priority, never split
  throughput,  ///< long work that yields: in slices, while there is urgent work (Device::hasUrgentWork)
  background   ///< work without a waiting caller: lowest priority, also in slices
};

/// Access to the GPU for one policy: submits in order and reports completion. Used by one thread at a time.
class Queue {
 public:
  /// Identifies one submission; incremented with each.
  using Ticket = std::uint64_t;

  Queue(Device& device, std::shared_ptr<SharedQueue> queue, std::uint32_t family, QueuePolicy policy);
  ~Queue();
  Queue(const Queue&) = delete;
  Queue& operator=(const Queue&) = delete;

  /// Another handle to the same driver queue, for another thread. Must be destroyed before the device.
  std::unique_ptr<Queue> another() const { return std::make_unique<Queue>(device_, queue_, family_, policy_); }
  std::uint32_t family() const { return family_; }
  QueuePolicy policy() const { return policy_; }
  /// Waits first if too many submissions are in flight.
  Ticket submit(const CommandList& list, const Semaphores& semaphores = {});
  /// Presents an image once `after` is signalled; returns the driver's result if it is not an error.
  VkResult present(VkSwapchainKHR swapchain, std::uint32_t image, VkSemaphore after);
  bool canPresent(VkSurfaceKHR surface) const;
  bool isDone(Ticket ticket) const;
  /// True when done, false after `timeout_us` (0: no timeout). Throws DeviceLost.
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

#include "engine/gpu/queue.hpp"

#include <mutex>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

Queue::Queue(Device& device, std::shared_ptr<SharedQueue> queue, std::uint32_t family)
    : device_(device), queue_(std::move(queue)), family_(family) {
  const VkFenceCreateInfo info{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .pNext = nullptr, .flags = 0};
  for (VkFence& fence : fences_)
    device_.check(device_.vk().vkCreateFence(device_.handle(), &info, nullptr, &fence), "vkCreateFence");
}

Queue::~Queue() {
  for (const VkFence fence : fences_) device_.vk().vkDestroyFence(device_.handle(), fence, nullptr);
}

Queue::Ticket Queue::submit(const CommandList& list) {
  if (broken_) throw GpuError("{}: an earlier submission failed", device_.name());
  const Ticket ticket = last_ + 1;
  const VkFence fence = fenceOf(ticket);
  if (ticket > kInFlight) {
    wait(ticket - kInFlight);
    device_.check(device_.vk().vkResetFences(device_.handle(), 1, &fence), "vkResetFences");
  }
  const VkCommandBufferSubmitInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .pNext = nullptr,
                                           .commandBuffer = list.handle(),
                                           .deviceMask = 0};
  const VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                           .pNext = nullptr,
                           .flags = 0,
                           .waitSemaphoreInfoCount = 0,
                           .pWaitSemaphoreInfos = nullptr,
                           .commandBufferInfoCount = 1,
                           .pCommandBufferInfos = &commands,
                           .signalSemaphoreInfoCount = 0,
                           .pSignalSemaphoreInfos = nullptr};
  {
    const std::scoped_lock hold(queue_->lock);
    const VkResult result = device_.vk().vkQueueSubmit2(queue_->handle, 1, &info, fence);
    broken_ = result != VK_SUCCESS;
    device_.check(result, "vkQueueSubmit2");
  }
  list.noteSubmission();
  last_ = ticket;
  return ticket;
}

bool Queue::isDone(Ticket ticket) const {
  if (ticket + kInFlight <= last_) return true;  // its fence serves a later one by now
  const VkResult result = device_.vk().vkGetFenceStatus(device_.handle(), fenceOf(ticket));
  device_.check(result, "vkGetFenceStatus");
  return result == VK_SUCCESS;
}

bool Queue::wait(Ticket ticket, Wait how, double timeout_us) const {
  if (how == Wait::block) {
    if (ticket + kInFlight <= last_) return true;
    const VkFence fence = fenceOf(ticket);
    const auto timeout_ns = timeout_us > 0 ? static_cast<std::uint64_t>(timeout_us * 1e3) : UINT64_MAX;
    const VkResult result = device_.vk().vkWaitForFences(device_.handle(), 1, &fence, VK_TRUE, timeout_ns);
    device_.check(result, "vkWaitForFences");
    return result == VK_SUCCESS;
  }
  const Stopwatch watch;
  while (!isDone(ticket)) {
    if (timeout_us > 0 && watch.elapsed_us() > timeout_us) return false;
    if (how == Wait::poll) std::this_thread::yield();
  }
  return true;
}

}  // namespace palpate

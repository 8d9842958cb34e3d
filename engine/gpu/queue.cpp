#include "engine/gpu/queue.hpp"

#include <mutex>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

Queue::Queue(Device& device, std::shared_ptr<SharedQueue> queue, std::uint32_t family, QueuePolicy policy)
    : device_(device), queue_(std::move(queue)), family_(family), policy_(policy) {
  const VkFenceCreateInfo info{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .pNext = nullptr, .flags = 0};
  for (VkFence& fence : fences_)
    device_.check(device_.vk().vkCreateFence(device_.handle(), &info, nullptr, &fence), "vkCreateFence");
}

Queue::~Queue() {
  for (const VkFence fence : fences_) device_.vk().vkDestroyFence(device_.handle(), fence, nullptr);
}

Queue::Ticket Queue::submit(const CommandList& list, const Semaphores& semaphores) {
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
  const auto semaphore = [](VkSemaphore handle, VkPipelineStageFlags2 stages) {
    return VkSemaphoreSubmitInfo{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                 .pNext = nullptr,
                                 .semaphore = handle,
                                 .value = 0,
                                 .stageMask = stages,
                                 .deviceIndex = 0};
  };
  const VkSemaphoreSubmitInfo waits =
      semaphore(semaphores.waits, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT);
  const VkSemaphoreSubmitInfo signalled = semaphore(semaphores.signals, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT);
  const VkSubmitInfo2 info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                           .pNext = nullptr,
                           .flags = 0,
                           .waitSemaphoreInfoCount = semaphores.waits ? 1u : 0u,
                           .pWaitSemaphoreInfos = &waits,
                           .commandBufferInfoCount = 1,
                           .pCommandBufferInfos = &commands,
                           .signalSemaphoreInfoCount = semaphores.signals ? 1u : 0u,
                           .pSignalSemaphoreInfos = &signalled};
  {
    const std::scoped_lock hold(*queue_);
    const VkResult result = device_.vk().vkQueueSubmit2(queue_->handle(), 1, &info, fence);
    broken_ = result != VK_SUCCESS;
    device_.check(result, "vkQueueSubmit2");
  }
  list.noteSubmission();
  last_ = ticket;
  return ticket;
}

VkResult Queue::present(VkSwapchainKHR swapchain, std::uint32_t image, VkSemaphore after) {
  const VkPresentInfoKHR info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                              .pNext = nullptr,
                              .waitSemaphoreCount = 1,
                              .pWaitSemaphores = &after,
                              .swapchainCount = 1,
                              .pSwapchains = &swapchain,
                              .pImageIndices = &image,
                              .pResults = nullptr};
  const std::scoped_lock hold(*queue_);
  const VkResult result = device_.vk().vkQueuePresentKHR(queue_->handle(), &info);
  if (result != VK_SUBOPTIMAL_KHR && result != VK_ERROR_OUT_OF_DATE_KHR) device_.check(result, "vkQueuePresentKHR");
  return result;
}

bool Queue::canPresent(VkSurfaceKHR surface) const {
  VkBool32 can = VK_FALSE;
  device_.check(vkGetPhysicalDeviceSurfaceSupportKHR(device_.physical(), family_, surface, &can),
                "vkGetPhysicalDeviceSurfaceSupportKHR");
  return can == VK_TRUE;
}

bool Queue::isDone(Ticket ticket) const {
  if (ticket + kInFlight <= last_) return true;  // its fence has been reused by a later submission
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

#include "engine/gpu/gpu_timer.hpp"

#include <array>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"

namespace palpate {

GpuTimer::GpuTimer(Device& device, std::uint32_t queueFamily)
    : device_(device), ticksMask_(device.timestampMask(queueFamily)) {
  const VkQueryPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                   .pNext = nullptr,
                                   .flags = 0,
                                   .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                   .queryCount = 2 * kMaxScopes,
                                   .pipelineStatistics = 0};
  device.check(device.vk().vkCreateQueryPool(device.handle(), &info, nullptr, &pool_), "vkCreateQueryPool");
}

GpuTimer::~GpuTimer() { device_.vk().vkDestroyQueryPool(device_.handle(), pool_, nullptr); }

void GpuTimer::reset(VkCommandBuffer commands) {
  scopes_ = 0;
  device_.vk().vkCmdResetQueryPool(commands, pool_, 0, 2 * kMaxScopes);
}

std::uint32_t GpuTimer::open(VkCommandBuffer commands) {
  PALPATE_CHECK_LT(scopes_, kMaxScopes);
  if (ticksMask_) device_.vk().vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, 2 * scopes_);
  return scopes_++;
}

void GpuTimer::close(VkCommandBuffer commands, std::uint32_t scope) {
  if (ticksMask_)
    device_.vk().vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool_, 2 * scope + 1);
}

double GpuTimer::time_us(std::uint32_t scope) const {
  if (!ticksMask_) return 0;
  std::array<std::uint64_t, 2> ticks{};
  const VkResult result =
      device_.vk().vkGetQueryPoolResults(device_.handle(), pool_, 2 * scope, 2, sizeof(ticks), ticks.data(),
                                         sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT);
  if (result == VK_NOT_READY) return 0;
  device_.check(result, "vkGetQueryPoolResults");
  return static_cast<double>((ticks[1] - ticks[0]) & ticksMask_) * device_.timestampPeriod_ns() * 1e-3;
}

}  // namespace palpate
